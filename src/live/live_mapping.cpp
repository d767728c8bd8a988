#include "pingvox/live/live_mapping.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "base/without_exceptions.hpp"
#include "device/internal/live_source.hpp"
#include "live/beam_queue.hpp"
#include "live/event_tracker.hpp"
#include "live/live_navigation.hpp"
#include "live/live_slam.hpp"
#include "live/obstacle_sender.hpp"
#include "live/open_head.hpp"
#include "live/recordings.hpp"
#include "mapping/internal/obstacle_sectors.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "pingvox/mapping/map_resolution.hpp"
#include "pingvox/recording/recording.hpp"

namespace pingvox {
namespace {

constexpr double kMapping_s = 0.01;  ///< between two looks at the lines, or one beam

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::uint64_t since_1970_ms() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count());
}

/// The clock, from 0.
LiveMapping::Clock started(LiveMapping::Clock clock) {
  if (!clock) clock = steady_s;
  return [clock, start_s = clock()] { return clock() - start_s; };
}

/// As asked, else by the range of the pings; of a replay as `build_map` of its log has it.
/// @param build  with the beam of the head
double resolution_of(const LiveOptions& options, const BuildOptions& build) {
  const LiveHead& head = options.head;
  if (options.map.resolution_m) return *options.map.resolution_m;
  if (head.kind != LiveHead::Kind::kReplay) {
    const double range_m = head.kind == LiveHead::Kind::kMicron ? head.micron.range_m : head.ping360.range_m;
    return resolution_for(std::min(range_m, build.echo.max_range_m), build.model.width_rad);
  }
  InputFile log(head.address);
  if (log.is_read_once()) return MapOptions::kDefaultResolution_m;
  const MapForecast forecast =
      Recording::open({std::move(log)}, {.head = options.beam})
          .and_then([&](const Recording& recording) { return forecast_map(recording, options.map, build); })
          .value_or(MapForecast{});
  return forecast.resolution_m;
}

/// @param map  made where the mapper has none of its own
Result<BeamQueue::Mapper> mapper_of(const LiveOptions& options, const BuildOptions& build,
                                    const MapOptions& map_options, std::unique_ptr<OccupancyMap>& map) {
  if (options.slam) {
    const auto navigation = options.nav.empty() ? LiveSlam::Navigation::kNone : LiveSlam::Navigation::kSome;
    return LiveSlam::make(*options.slam, navigation, build, map_options).map([](LiveSlam slam) {
      return BeamQueue::Mapper(std::move(slam));
    });
  }
  Result<OccupancyMap> made = OccupancyMap::make(map_options);
  if (!made) return tl::unexpected(made.error());
  map = std::make_unique<OccupancyMap>(*std::move(made));
  return BeamMapper::make(build, *map, CountSweeps::kYes).map([](BeamMapper mapper) {
    return BeamQueue::Mapper(std::move(mapper));
  });
}

ObstacleOptions obstacle_options(const LiveHead& head) {
  return {.max_range_m = head.kind == LiveHead::Kind::kMicron ? head.micron.range_m : head.ping360.range_m};
}

}  // namespace

class LiveMapping::Run {
 public:
  /// What a run is made of.
  struct Parts {
    Clock clock;
    double since_1970_s;                ///< at its 0
    std::unique_ptr<OccupancyMap> map;  ///< nullptr: SLAM has it
    std::unique_ptr<LiveSource> source;
    std::optional<LiveNavigation> nav;
    BeamQueue::Mapper mapper;
    std::vector<std::filesystem::path> recordings;
  };

  Run(const LiveOptions& options, Parts parts)
      : clock_(std::move(parts.clock)),
        since_1970_s_(parts.since_1970_s),
        map_(std::move(parts.map)),
        source_(std::move(parts.source)),
        nav_(std::move(parts.nav)),
        queue_(std::move(parts.mapper)),
        recordings_(std::move(parts.recordings)),
        events_(options.head.name(), source_->status(), nav()) {
    if (options.obstacles) obstacles_.emplace(*options.obstacles, obstacle_options(options.head));
  }

  void wait(double seconds, int file) const {
    constexpr double kMax_s = 1.0, kMs_per_s = 1000.0;
    // poll() passes over -1.
    std::vector<pollfd> files = {{file, POLLIN, 0}, {source_->descriptor(), POLLIN, 0}};
    if (nav_) {
      for (const NavDevice& device : nav_->devices()) files.push_back({device.descriptor(), POLLIN, 0});
    }
    if (queue_.can_map_one(nav(), time_s())) seconds = 0.0;
    seconds = std::clamp(std::min(seconds, due_s() - time_s()), 0.0, kMax_s);
    ::poll(files.data(), files.size(), static_cast<int>(std::ceil(seconds * kMs_per_s)));
  }

  Result<bool> step() {
    if (has_ended_) return false;
    const Result<bool> goes_on = source_->step(time_s(), arrived_);
    // What was mapped until then stays.
    has_ended_ = !goes_on || !*goes_on;
    if (nav_) {
      const Result<void> read = step_nav(time_s());
      if (!read && !std::exchange(has_nav_failed_, true)) events_.add(live_event::NavFailed{read.error()});
    }
    push_arrived();
    map_some();
    update_events();
    const double now_s = time_s();
    if (obstacles_ && now_s >= obstacles_->due_s()) obstacles_->send(map(), pose_for_obstacles(now_s), now_s);
    return goes_on;
  }

  Result<void> finish() {
    has_ended_ = true;
    source_->finish(arrived_);
    push_arrived();
    Result<void> mapped;
    while (!queue_.empty()) {
      if (auto one = queue_.map_one(nav(), clock_); !one) mapped = std::move(one);
    }
    if (auto last = queue_.finish(); !last) mapped = std::move(last);
    update_events();
    return mapped;
  }

  const OccupancyMap& map() const { return queue_.slam() != nullptr ? queue_.slam()->map() : *map_; }
  const BuildReport& report() const { return queue_.report(); }
  SweepCoverage coverage() const { return queue_.coverage(); }
  double time_s() const { return clock_(); }
  double since_1970_s() const { return since_1970_s_; }
  std::size_t beams() const { return queue_.beams(); }
  const std::vector<std::filesystem::path>& recordings() const { return recordings_; }
  std::optional<Trajectory> path() const { return queue_.slam() != nullptr ? queue_.slam()->path() : std::nullopt; }
  const SlamSolution* slam_solution() const {
    return queue_.slam() != nullptr && queue_.slam()->solution() ? &*queue_.slam()->solution() : nullptr;
  }
  std::vector<LiveEvent> take_events() { return events_.take(); }
  double take_latency_s() { return queue_.take_latency_s(); }

  LiveStatus status() const {
    LiveStatus status;
    status.time_s = time_s();
    status.head = source_->status();
    status.beams = queue_.beams();
    status.mapped = queue_.report().beams;
    status.not_mapped = queue_.not_mapped();
    status.waiting = queue_.waiting();
    status.without_pose = queue_.without_pose();
    if (queue_.slam() != nullptr) status.slam = queue_.slam()->status();
    if (!nav_) return status;
    for (const NavDevice& device : nav_->devices()) status.nav.push_back(device.status());
    status.attitude = nav_->poses().attitude();
    status.position = nav_->poses().position();
    status.outliers = nav_->poses().outliers();
    status.new_frames = events_.new_frames();
    return status;
  }

 private:
  /// nullptr: the vehicle stands still.
  const LiveNavigation* nav() const { return nav_ ? &*nav_ : nullptr; }

  double due_s() const { return obstacles_ ? std::min(source_->due_s(), obstacles_->due_s()) : source_->due_s(); }

  Result<void> step_nav(double now_s) {
    if (queue_.slam() == nullptr) return nav_->step(now_s);
    return nav_->step(now_s,
                      [slam = queue_.slam()](std::size_t device, const std::string& source, NavQuantity quantity,
                                             const NavSample& sample) { slam->add(device, source, quantity, sample); });
  }

  void push_arrived() {
    if (!arrived_.empty()) last_beam_s_ = time_s();
    queue_.push(arrived_, time_s());
  }

  void map_some() {
    for (const double until_s = time_s() + kMapping_s; queue_.can_map_one(nav(), time_s());) {
      if (const Result<void> mapped = queue_.map_one(nav(), clock_); !mapped) {
        events_.add(live_event::MappingFailed{mapped.error()});
      }
      if (time_s() >= until_s) break;
    }
    if (const Result<void> updated = queue_.update(time_s()); !updated) {
      events_.add(live_event::MappingFailed{updated.error()});
    }
  }

  void update_events() {
    events_.update_head(source_->status());
    if (obstacles_) events_.update_obstacles(obstacles_->problem());
    if (nav_) events_.update_nav(*nav_);
    if (queue_.slam() != nullptr) {
      for (LiveEvent& event : queue_.slam()->take_events()) events_.add(std::move(event));
    } else if (nav_) {
      events_.update_poses(*nav_);
    }
  }

  /// The latest one that is known. nullopt: it, or the last beam, is too old to say where obstacles are.
  std::optional<Pose> pose_for_obstacles(double now_s) const {
    constexpr double kOldestBeam_s = 5.0, kOldestPose_s = 2.0;
    if (queue_.has_failed() || !last_beam_s_ || now_s - *last_beam_s_ > kOldestBeam_s) return std::nullopt;
    if (queue_.slam() != nullptr) {
      const std::optional<StampedPose> last = queue_.slam()->pose();
      return last && now_s - last->time_s <= kOldestPose_s ? std::optional(last->map_from_body) : std::nullopt;
    }
    if (!nav_) return Pose::Identity();
    const std::optional<double> until_s = nav_->poses().known_until_s();
    return until_s && nav_->pose_age_s() <= kOldestPose_s ? nav_->poses().at(*until_s) : std::nullopt;
  }

  Clock clock_;
  double since_1970_s_;
  std::unique_ptr<OccupancyMap> map_;
  std::unique_ptr<LiveSource> source_;
  std::optional<LiveNavigation> nav_;
  std::optional<ObstacleSender> obstacles_;
  BeamQueue queue_;  ///< maps into map_
  std::vector<std::filesystem::path> recordings_;
  EventTracker events_;
  std::vector<Beam> arrived_;
  std::optional<double> last_beam_s_;  ///< when it arrived
  bool has_ended_ = false, has_nav_failed_ = false;
};

Result<LiveMapping> LiveMapping::open(const LiveOptions& options, Clock clock) {
  return detail::without_exceptions([&]() -> Result<LiveMapping> {
    if (const Result<void> valid = options.validate(); !valid) return tl::unexpected(valid.error());
    Clock since_start = started(std::move(clock));
    const std::uint64_t start_ms = since_1970_ms();
    Result<std::optional<std::filesystem::path>> record = record_path(options, start_ms);
    if (!record) return tl::unexpected(record.error());
    Recordings recordings(*std::move(record));
    Result<std::unique_ptr<LiveSource>> source = open_head(options.head, recordings, start_ms);
    if (!source) return tl::unexpected(source.error());
    std::optional<LiveNavigation> nav;
    constexpr double kMs_per_s = 1000.0;
    const double start_s = static_cast<double>(start_ms) / kMs_per_s;
    if (!options.nav.empty()) {
      auto opened = LiveNavigation::open(options.nav, recordings, start_s);
      if (!opened) return tl::unexpected(opened.error());
      nav = *std::move(opened);
    }
    const bool is_replay = options.head.kind == LiveHead::Kind::kReplay;
    BuildOptions build = options.build;
    build.model = options.beam.apply_to(build.model, (*source)->device());
    MapOptions map_options = options.map;
    map_options.resolution_m = resolution_of(options, build);
    std::unique_ptr<OccupancyMap> own_map;
    Result<BeamQueue::Mapper> mapper = mapper_of(options, build, map_options, own_map);
    if (!mapper) return tl::unexpected(mapper.error());
    return LiveMapping(std::make_unique<Run>(
        options, Run::Parts{std::move(since_start), is_replay ? 0.0 : start_s, std::move(own_map), *std::move(source),
                            std::move(nav), *std::move(mapper), recordings.keep()}));
  });
}

LiveMapping::LiveMapping(std::unique_ptr<Run> run) : run_(std::move(run)) {}
LiveMapping::LiveMapping(LiveMapping&&) noexcept = default;
LiveMapping& LiveMapping::operator=(LiveMapping&&) noexcept = default;
LiveMapping::~LiveMapping() = default;

void LiveMapping::wait(double seconds, int file) const {
  run_->wait(seconds, file);
}

Result<bool> LiveMapping::step() {
  return detail::without_exceptions([&] { return run_->step(); });
}

Result<void> LiveMapping::finish() {
  return detail::without_exceptions([&] { return run_->finish(); });
}

const OccupancyMap& LiveMapping::map() const {
  return run_->map();
}

const BuildReport& LiveMapping::report() const {
  return run_->report();
}

SweepCoverage LiveMapping::coverage() const {
  return run_->coverage();
}

double LiveMapping::time_s() const {
  return run_->time_s();
}

double LiveMapping::since_1970_s() const {
  return run_->since_1970_s();
}

std::size_t LiveMapping::beams() const {
  return run_->beams();
}

LiveStatus LiveMapping::status() const {
  return run_->status();
}

const std::vector<std::filesystem::path>& LiveMapping::recordings() const {
  return run_->recordings();
}

std::optional<Trajectory> LiveMapping::path() const {
  return run_->path();
}

const SlamSolution* LiveMapping::slam_solution() const {
  return run_->slam_solution();
}

std::vector<LiveEvent> LiveMapping::take_events() {
  return run_->take_events();
}

double LiveMapping::take_latency_s() {
  return run_->take_latency_s();
}

}  // namespace pingvox
