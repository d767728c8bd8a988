#include "pingvox/mapping/rebuilt_map.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "mapping/echo_mapper.hpp"

namespace pingvox {
namespace {

/// Pose of the vehicle at the time of a beam.
struct BeamPose {
  double time_s;
  std::optional<Pose> map_from_body;
};

/// Beams from the stream of echoes, in order. They never change, so threads may share them.
using Heard = std::shared_ptr<const detail::EchoBeams>;

/// A map with its mapper.
class MapBuild {
 public:
  MapBuild(const BuildOptions& build, OccupancyMap map) : map_(std::move(map)), mapper_(build, map_) {}
  MapBuild(const MapBuild&) = delete;
  MapBuild& operator=(const MapBuild&) = delete;

  /// @param poses  of all beams, by their numbers
  Result<void> add(const detail::EchoBeams& heard, std::span<const BeamPose> poses) {
    Result<void> added = detail::without_exceptions([&] {
      map_from_body_.clear();
      for (const std::uint64_t number : heard.numbers) map_from_body_.push_back(poses[number].map_from_body);
      return mapper_.add(heard, map_from_body_, report_);
    });
    if (!added) mapper_.restart(report_);
    return added;
  }

  const OccupancyMap& map() const { return map_; }
  const BuildReport& report() const { return report_; }

 private:
  OccupancyMap map_;
  detail::EchoMapper mapper_;
  BuildReport report_;
  std::vector<std::optional<Pose>> map_from_body_;
};

Result<std::unique_ptr<MapBuild>> make_empty(const BuildOptions& build, const MapOptions& options) {
  return detail::without_exceptions([&]() -> Result<std::unique_ptr<MapBuild>> {
    Result<OccupancyMap> map = OccupancyMap::make(options);
    if (!map) return tl::unexpected(map.error());
    return std::make_unique<MapBuild>(build, *std::move(map));
  });
}

/// Beams after the end of a trajectory are moved as the last one before it.
std::vector<BeamPose> correct_poses(std::vector<BeamPose> poses, const Trajectory& map_from_body) {
  const double end_s = map_from_body.poses().back().time_s;
  Pose moved = Pose::Identity();
  for (BeamPose& beam : poses) {
    std::optional<Pose> pose = map_from_body.at(beam.time_s);
    if (pose && beam.map_from_body) moved = *pose * beam.map_from_body->inverse();
    if (!pose && beam.map_from_body && beam.time_s > end_s) pose = moved * *beam.map_from_body;
    beam.map_from_body = pose;
  }
  return poses;
}

/// A map that is built in a thread of its own.
class Rebuild {
 public:
  Rebuild(const BuildOptions& build, const MapOptions& map, std::vector<Heard> heard, std::vector<BeamPose> poses)
      : build_(build), map_(map), heard_(std::move(heard)), poses_(std::move(poses)) {
    try {
      thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    } catch (const std::system_error&) {  // no thread could be started: the caller waits
      run({});
    }
  }

  bool is_done() const { return is_done_; }
  /// How many of the beams heard are in it.
  std::size_t count() const { return heard_.size(); }
  /// Waits for it. REQUIRES that it is called once.
  Result<std::unique_ptr<MapBuild>> take() {
    if (thread_.joinable()) thread_.join();
    return std::move(made_);
  }

 private:
  void run(const std::stop_token& stop) {
    made_ = detail::without_exceptions([&] { return make(stop); });
    is_done_ = true;
  }
  Result<std::unique_ptr<MapBuild>> make(const std::stop_token& stop) const {
    Result<std::unique_ptr<MapBuild>> made = make_empty(build_, map_);
    for (std::size_t n = 0; made && n < heard_.size() && !stop.stop_requested(); ++n) {
      if (const auto added = (*made)->add(*heard_[n], poses_); !added) return tl::unexpected(added.error());
    }
    return made;
  }

  BuildOptions build_;
  MapOptions map_;
  std::vector<Heard> heard_;
  std::vector<BeamPose> poses_;
  Result<std::unique_ptr<MapBuild>> made_ = nullptr;
  std::atomic<bool> is_done_ = false;
  std::jthread thread_;  ///< the last member: it is stopped and joined first
};

}  // namespace

class RebuiltMap::State {
 public:
  State(const BuildOptions& build, const MapOptions& map, std::unique_ptr<MapBuild> empty)
      : build_(build),
        map_(map),
        empty_stream_(detail::echo_stream(build)),
        stream_(empty_stream_),
        made_(std::move(empty)) {}

  Result<void> add(Beam beam, const std::optional<Pose>& map_from_body) {
    const auto added = or_restart([&] {
      poses_.push_back({beam.time_s, map_from_body});
      beam.bin_length_m *= build_.sound_speed_ratio;
      return take(stream_.add(std::move(beam)));
    });
    const Result<void> updated = update();
    return added ? updated : added;
  }

  Result<void> finish() {
    const auto finished = or_restart([&] { return take(stream_.finish()); });
    const Result<void> updated = update();
    return finished ? updated : finished;
  }

  Result<void> correct(const Trajectory& map_from_body) {
    return detail::without_exceptions([&]() -> Result<void> {
      std::vector<BeamPose> poses = correct_poses(poses_, map_from_body);
      if (rebuild_) {
        is_outdated_ = true;
      } else {
        rebuild_ = std::make_unique<Rebuild>(build_, map_, heard_, poses);
      }
      poses_ = std::move(poses);
      return {};
    });
  }

  bool is_rebuilding() const { return rebuild_ != nullptr; }

  Result<void> update() { return rebuild_ && rebuild_->is_done() ? swap() : Result<void>(); }

  Result<void> wait() {
    Result<void> all;
    while (rebuild_) {
      const Result<void> swapped = swap();
      if (all) all = swapped;
    }
    return all;
  }

  const MapBuild& made() const { return *made_; }

 private:
  /// Calls f. After an error the beams that wait for their echo are incomplete, and dropped.
  template <class F>
  Result<void> or_restart(const F& f) {
    Result<void> done = detail::without_exceptions(f);
    if (done) return done;
    stream_ = empty_stream_;
    first_ = poses_.size();
    sweeps_ = 0;
    return done;
  }

  Result<void> take(const std::vector<EchoStream::BeamWithEcho>& final_echoes) {
    const std::size_t sweeps_before = std::exchange(sweeps_, stream_.complete_sweeps());
    detail::EchoBeams heard = detail::echo_beams(final_echoes, first_, sweeps_ - sweeps_before);
    if (heard.beams.empty() && heard.ended_sweeps == 0) return {};
    heard_.push_back(std::make_shared<const detail::EchoBeams>(std::move(heard)));
    Result<void> added = made_->add(*heard_.back(), poses_);
    if (!added) heard_.pop_back();  // or no rebuilt map would come about either
    return added;
  }

  /// The rebuilt map gets the beams that came meanwhile and takes the place of the old one.
  Result<void> swap() {
    const std::size_t done = rebuild_->count();
    Result<std::unique_ptr<MapBuild>> made = rebuild_->take();
    rebuild_.reset();
    for (std::size_t n = done; made && n < heard_.size(); ++n) {
      if (const auto added = (*made)->add(*heard_[n], poses_); !added) made = tl::unexpected(added.error());
    }
    Result<void> swapped;
    if (made) {
      made_ = *std::move(made);
    } else {
      swapped = tl::unexpected(made.error());
    }
    if (!std::exchange(is_outdated_, false)) return swapped;
    const Result<void> next = detail::without_exceptions([&]() -> Result<void> {
      rebuild_ = std::make_unique<Rebuild>(build_, map_, heard_, poses_);
      return {};
    });
    return swapped ? next : swapped;
  }

  BuildOptions build_;
  MapOptions map_;
  EchoStream empty_stream_;  ///< to restart without an allocation
  EchoStream stream_;
  std::uint64_t first_ = 0;      ///< number of the stream's first beam
  std::size_t sweeps_ = 0;       ///< complete ones of the stream, so far
  std::vector<BeamPose> poses_;  ///< of all beams
  std::vector<Heard> heard_;
  std::unique_ptr<MapBuild> made_;
  bool is_outdated_ = false;  ///< poses were corrected since the rebuild began
  std::unique_ptr<Rebuild> rebuild_;
};

Result<RebuiltMap> RebuiltMap::make(const BuildOptions& build, const MapOptions& map) {
  return detail::without_exceptions([&]() -> Result<RebuiltMap> {
    if (const auto valid = build.validate(); !valid) return tl::unexpected(valid.error());
    Result<std::unique_ptr<MapBuild>> empty = make_empty(build, map);
    if (!empty) return tl::unexpected(empty.error());
    return RebuiltMap(std::make_unique<State>(build, map, *std::move(empty)));
  });
}

RebuiltMap::RebuiltMap(std::unique_ptr<State> state) : state_(std::move(state)) {}
RebuiltMap::RebuiltMap(RebuiltMap&&) noexcept = default;
RebuiltMap& RebuiltMap::operator=(RebuiltMap&&) noexcept = default;
RebuiltMap::~RebuiltMap() = default;

Result<void> RebuiltMap::add(Beam beam, const std::optional<Pose>& map_from_body) {
  return state_->add(std::move(beam), map_from_body);
}
Result<void> RebuiltMap::finish() {
  return state_->finish();
}
Result<void> RebuiltMap::correct(const Trajectory& map_from_body) {
  return state_->correct(map_from_body);
}
bool RebuiltMap::is_rebuilding() const {
  return state_->is_rebuilding();
}
Result<void> RebuiltMap::update() {
  return state_->update();
}
Result<void> RebuiltMap::wait() {
  return state_->wait();
}
const OccupancyMap& RebuiltMap::map() const {
  return state_->made().map();
}
const BuildReport& RebuiltMap::report() const {
  return state_->made().report();
}

}  // namespace pingvox
