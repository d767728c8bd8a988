#include "pingvox/mapping/rebuilt_map.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "geometry/internal/compact_pose.hpp"
#include "mapping/echo_mapper.hpp"

namespace pingvox {
namespace {

/// map_from_body of all beams, by their numbers. A list that grows without copies of what it has.
using BeamPoses = std::deque<CompactPose>;

/// Beams from the stream of echoes, in order. They never change, so threads may share them.
using Heard = std::shared_ptr<const detail::EchoBeams>;

/// A map with its mapper.
class MapBuild {
 public:
  MapBuild(const BuildOptions& build, OccupancyMap map) : map_(std::move(map)), mapper_(build, map_) {}
  MapBuild(const MapBuild&) = delete;
  MapBuild& operator=(const MapBuild&) = delete;

  Result<void> add(const detail::EchoBeams& heard, const BeamPoses& poses) {
    Result<void> added = detail::without_exceptions([&] {
      map_from_body_.clear();
      for (const std::uint64_t number : heard.numbers) map_from_body_.push_back(poses[number].pose());
      return mapper_.add(heard, map_from_body_, report_);
    });
    if (!added) mapper_.restart(report_);
    return added;
  }

  void track(ChangedPages* changes) { mapper_.track(changes); }
  const OccupancyMap& map() const { return map_; }
  const BuildReport& report() const { return report_; }

 private:
  OccupancyMap map_;
  detail::EchoMapper mapper_;
  BuildReport report_;
  std::vector<std::optional<Pose>> map_from_body_;
};

/// The map that is extended, which threads share.
using Base = std::shared_ptr<const OccupancyMap>;

/// With the base alone. Throws std::bad_alloc.
std::unique_ptr<MapBuild> make_build(const BuildOptions& build, const OccupancyMap& base) {
  return std::make_unique<MapBuild>(build, base);
}

/// Beams after the end of a trajectory are moved as the last one before it.
BeamPoses correct_poses(BeamPoses poses, const Trajectory& map_from_body) {
  const double end_s = map_from_body.poses().back().time_s;
  Pose moved = Pose::Identity();
  for (CompactPose& beam : poses) {
    const std::optional<Pose> before = beam.pose();
    std::optional<Pose> pose = map_from_body.at(beam.time_s);
    if (pose && before) moved = *pose * before->inverse();
    if (!pose && before && beam.time_s > end_s) pose = moved * *before;
    beam.set(pose);
  }
  return poses;
}

/// A map that is built in a thread of its own.
class Rebuild {
 public:
  Rebuild(const BuildOptions& build, Base base, std::deque<Heard> heard, BeamPoses poses)
      : build_(build), base_(std::move(base)), heard_(std::move(heard)), poses_(std::move(poses)) {
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
    std::unique_ptr<MapBuild> made = make_build(build_, *base_);
    for (std::size_t n = 0; n < heard_.size() && !stop.stop_requested(); ++n) {
      if (const auto added = made->add(*heard_[n], poses_); !added) return tl::unexpected(added.error());
    }
    return made;
  }

  BuildOptions build_;
  Base base_;
  std::deque<Heard> heard_;
  BeamPoses poses_;
  Result<std::unique_ptr<MapBuild>> made_ = nullptr;
  std::atomic<bool> is_done_ = false;
  std::jthread thread_;  ///< the last member: it is stopped and joined first
};

}  // namespace

class RebuiltMap::State {
 public:
  State(const BuildOptions& build, OccupancyMap base)
      : build_(build),
        base_(std::make_shared<const OccupancyMap>(std::move(base))),
        empty_stream_(detail::echo_stream(build)),
        stream_(empty_stream_),
        made_(make_build(build, *base_)) {}

  Result<void> add(Beam beam, const std::optional<Pose>& map_from_body) {
    const auto added = or_restart([&] {
      poses_.emplace_back(beam.time_s, map_from_body);
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
      BeamPoses poses = correct_poses(poses_, map_from_body);
      if (rebuild_) {
        is_outdated_ = true;
      } else {
        rebuild_ = std::make_unique<Rebuild>(build_, base_, heard_, poses);
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

  void track(ChangedPages* changes) {
    changes_ = changes;
    made_->track(changes);
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
      made_->track(changes_);
      if (changes_ != nullptr) changes_->add_all();
    } else {
      swapped = tl::unexpected(made.error());
    }
    if (!std::exchange(is_outdated_, false)) return swapped;
    const Result<void> next = detail::without_exceptions([&]() -> Result<void> {
      rebuild_ = std::make_unique<Rebuild>(build_, base_, heard_, poses_);
      return {};
    });
    return swapped ? next : swapped;
  }

  BuildOptions build_;
  Base base_;
  EchoStream empty_stream_;  ///< to restart without an allocation
  EchoStream stream_;
  std::uint64_t first_ = 0;  ///< number of the stream's first beam
  std::size_t sweeps_ = 0;   ///< complete ones of the stream, so far
  BeamPoses poses_;
  std::deque<Heard> heard_;
  std::unique_ptr<MapBuild> made_;
  ChangedPages* changes_ = nullptr;
  bool is_outdated_ = false;  ///< poses were corrected since the rebuild began
  std::unique_ptr<Rebuild> rebuild_;
};

Result<RebuiltMap> RebuiltMap::make(const BuildOptions& build, const MapOptions& map) {
  return OccupancyMap::make(map).and_then([&](OccupancyMap empty) { return extend(build, std::move(empty)); });
}

Result<RebuiltMap> RebuiltMap::extend(const BuildOptions& build, OccupancyMap base) {
  return detail::without_exceptions([&]() -> Result<RebuiltMap> {
    if (const auto valid = build.validate(); !valid) return tl::unexpected(valid.error());
    return RebuiltMap(std::make_unique<State>(build, std::move(base)));
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
void RebuiltMap::track(ChangedPages* changes) {
  state_->track(changes);
}
const OccupancyMap& RebuiltMap::map() const {
  return state_->made().map();
}
const BuildReport& RebuiltMap::report() const {
  return state_->made().report();
}

}  // namespace pingvox
