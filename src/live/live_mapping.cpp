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
#include "live/open_mapper.hpp"
#include "live/recordings.hpp"
#include "live/ros2_publisher.hpp"
#include "mapping/internal/obstacle_sectors.hpp"

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

/// The settings by which the head is driven; nullopt of a replay.
std::optional<DrivenHead> driven(const LiveHead& head) {
  if (head.kind == LiveHead::Kind::kReplay) return std::nullopt;
  return head.kind == LiveHead::Kind::kMicron ? DrivenHead(head.micron) : DrivenHead(head.ping360);
}

/// nullopt: nothing is read or published.
Result<std::optional<Ros2Node>> node_of(const LiveOptions& options) {
  if (!options.uses_ros2()) return std::nullopt;
  return Ros2Node::open(options.ros2).map([](Ros2Node node) { return std::optional(std::move(node)); });
}

Result<std::optional<Ros2Publisher>> publisher_of(const LiveOptions& options, const std::optional<Ros2Node>& node,
                                                  const std::optional<LiveNavigation>& nav) {
  if (!options.publish || !node) return std::nullopt;
  // A vehicle whose poses are those of a node of ROS has its transforms from there.
  const bool is_placed = nav && std::ranges::any_of(nav->devices(), [&](const NavDevice& device) {
                           return device.reads_tf() || (!options.slam && device.kind() == LiveNav::Kind::kRos2);
                         });
  return Ros2Publisher::open(*node, *options.publish, is_placed ? PublishTf::kNo : PublishTf::kYes)
      .map([](Ros2Publisher publisher) { return std::optional(std::move(publisher)); });
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
    double since_1970_s;  ///< at its 0; of a replay, which has its own times, 0
    double start_s;       ///< since 1970
    std::unique_ptr<LiveSource> source;
    std::optional<LiveNavigation> nav;
    std::optional<Ros2Publisher> publisher;
    BuildOptions build;  ///< with the beam of the head
    MapOptions map;      ///< with a resolution
    MapperAndMap mapper;
    std::vector<std::filesystem::path> recordings;
  };

  Run(const LiveOptions& options, Parts parts)
      : clock_(std::move(parts.clock)),
        since_1970_s_(parts.since_1970_s),
        start_s_(parts.start_s),
        options_(options),
        build_(std::move(parts.build)),
        map_options_(parts.map),
        map_(std::move(parts.mapper.map)),
        source_(std::move(parts.source)),
        nav_(std::move(parts.nav)),
        publisher_(std::move(parts.publisher)),
        queue_(std::move(parts.mapper.mapper)),
        recordings_(std::move(parts.recordings)),
        events_(options.head.name(), source_->status(), nav()) {
    if (options.obstacles) obstacles_.emplace(*options.obstacles, obstacle_options(options.head));
    track();
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
    if (publisher_) publish(now_s);
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
    if (publisher_) {
      publisher_->finish();
      publisher_->publish_map(map(), time_s(), start_s_ + time_s());
      publisher_->finish();
    }
    update_events();
    return mapped;
  }

  const OccupancyMap& map() const { return queue_.slam() != nullptr ? queue_.slam()->map() : *map_; }
  const BuildReport& report() const { return queue_.report(); }
  SweepCoverage coverage() const { return queue_.coverage(); }
  double time_s() const { return clock_(); }
  double since_1970_s() const { return since_1970_s_; }
  std::size_t beams() const { return beams_of_maps_before_ + queue_.beams(); }
  const std::vector<std::filesystem::path>& recordings() const { return recordings_; }
  std::optional<Trajectory> path() const { return queue_.slam() != nullptr ? queue_.slam()->path() : std::nullopt; }
  const SlamSolution* slam_solution() const {
    return queue_.slam() != nullptr && queue_.slam()->solution() ? &*queue_.slam()->solution() : nullptr;
  }
  std::optional<StampedPose> pose() const {
    if (queue_.slam() != nullptr) return queue_.slam()->pose();
    if (!nav_) return StampedPose{last_beam_s_.value_or(0.0), Pose::Identity()};
    const std::optional<double> until_s = nav_->poses().known_until_s();
    const std::optional<Pose> pose = until_s ? nav_->poses().at(*until_s) : std::nullopt;
    return pose ? std::optional(StampedPose{*until_s, *pose}) : std::nullopt;
  }

  LiveChanges take_changes() { return {std::exchange(new_beams_, {}), changes_.take()}; }
  const LiveHead& head() const { return options_.head; }
  const BuildOptions& build() const { return build_; }

  Result<void> drive(const LiveHead& head) {
    LiveHead next = options_.head;
    next.ping360 = head.ping360;
    next.micron = head.micron;
    if (const auto valid = next.validate(); !valid) return valid;
    const std::optional<DrivenHead> settings = driven(next);
    if (!settings) return fail(Error::Code::kUnsupported, "a replay cannot be changed");
    if (const auto taken = source_->drive(*settings); !taken) return tl::unexpected(taken.error());
    options_.head = std::move(next);
    if (obstacles_) obstacles_->set(obstacle_options(options_.head));
    return {};
  }

  Result<void> begin_recording() {
    if (!options_.record) return fail(Error::Code::kBadOption, "record: nothing is named to record to");
    Result<std::optional<std::filesystem::path>> path = record_path(options_, since_1970_ms());
    if (!path) return tl::unexpected(path.error());
    Recordings recordings(*std::move(path));
    constexpr double kMs_per_s = 1000.0;
    // Dated as this run, whose clock the records have.
    const auto start_ms = static_cast<std::uint64_t>(std::llround(since_1970_s_ * kMs_per_s));
    Result<std::optional<HeadRecorder>> recorder = head_recorder(options_.head, recordings, start_ms);
    if (!recorder) return tl::unexpected(recorder.error());
    Result<void> begun = nav_ ? nav_->record(recordings) : Result<void>();
    if (begun) begun = source_->record_to(*std::move(recorder));
    if (!begun) {
      end_recording();
      return begun;
    }
    for (std::filesystem::path& file : recordings.keep()) recordings_.push_back(std::move(file));
    return {};
  }

  void end_recording() {
    static_cast<void>(source_->record_to(std::nullopt));
    Recordings none(std::nullopt);
    if (nav_) static_cast<void>(nav_->record(none));
  }

  bool is_recording() const { return source_->is_recording(); }

  Result<OccupancyMap> begin_new_map() {
    Result<MapperAndMap> made = open_mapper(options_, build_, map_options_);
    if (!made) return tl::unexpected(made.error());
    // SLAM has the map of the path as it is known now: its last solution would take long.
    if (queue_.slam() == nullptr && !queue_.has_failed()) {
      if (const auto finished = queue_.finish(); !finished) events_.add(live_event::MappingFailed{finished.error()});
    }
    OccupancyMap before = map_ ? OccupancyMap(std::move(*map_)) : OccupancyMap(map());
    beams_of_maps_before_ += queue_.restart(std::move(made->mapper));
    map_ = std::move(made->map);
    changes_.add_all();
    track();
    return before;
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
  /// nullptr: the vehicle does not move.
  const LiveNavigation* nav() const { return nav_ ? &*nav_ : nullptr; }

  double due_s() const { return obstacles_ ? std::min(source_->due_s(), obstacles_->due_s()) : source_->due_s(); }

  Result<void> step_nav(double now_s) {
    if (queue_.slam() == nullptr) return nav_->step(now_s);
    return nav_->step(now_s,
                      [slam = queue_.slam()](std::size_t device, const std::string& source, NavQuantity quantity,
                                             const NavSample& sample) { slam->add(device, source, quantity, sample); });
  }

  /// What a published map is made of: another one when any of these is.
  struct MapState {
    std::size_t maps_before = 0, beams = 0, corrections = 0;
    friend bool operator==(const MapState&, const MapState&) = default;
  };
  MapState map_state() const {
    const std::size_t corrections = queue_.slam() != nullptr ? queue_.slam()->status().corrections : 0;
    return {beams_of_maps_before_, queue_.report().beams, corrections};
  }

  void publish(double now_s) {
    if (publisher_->is_map_due(now_s) && map_state() != published_) {
      publisher_->publish_map(map(), now_s, start_s_ + now_s);
      published_ = map_state();
    }
    const std::optional<StampedPose> last = pose();
    if (!last) return;
    // A replay has the times of its log.
    const bool is_replay = options_.head.kind == LiveHead::Kind::kReplay;
    publisher_->publish_pose(*last, start_s_ + (is_replay ? now_s : last->time_s));
  }

  void track() {
    if (options_.changes == KeepChanges::kYes) queue_.track(&changes_);
  }

  void keep_new_beams() {
    if (options_.changes == KeepChanges::kNo) return;
    new_beams_.insert(new_beams_.end(), arrived_.begin(), arrived_.end());
    // Not beam by beam, as all are moved.
    if (new_beams_.size() < 2 * LiveChanges::kMaxBeams) return;
    new_beams_.erase(new_beams_.begin(), new_beams_.end() - LiveChanges::kMaxBeams);
  }

  /// Of the latest beam that came. Only those of ROS 2 have stamps of another clock: others get theirs when they come.
  /// The reader of a topic keeps each message until the next one comes, so a beam came when the one before was handed
  /// on.
  void note_arrival(double stamp_s, double now_s) {
    const bool has_stamps = options_.head.kind == LiveHead::Kind::kRos2;
    if (nav_ && (!has_stamps || last_beam_s_)) nav_->note_beam(has_stamps ? *last_beam_s_ - stamp_s : 0.0);
    newest_beam_s_ = stamp_s;
    last_beam_s_ = now_s;
  }

  void push_arrived() {
    if (!arrived_.empty()) note_arrival(arrived_.back().time_s, time_s());
    keep_new_beams();
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
    if (publisher_) events_.update_publishing(publisher_->problem());
    if (nav_) events_.update_nav(*nav_);
    if (queue_.slam() != nullptr) {
      for (LiveEvent& event : queue_.slam()->take_events()) events_.add(std::move(event));
    } else if (nav_) {
      events_.update_poses(*nav_, {{newest_beam_s_, last_beam_s_.value_or(0.0)}, queue_.asked()});
    }
    if (nav_) events_.update_clocks(*nav_);
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
  double since_1970_s_, start_s_;
  LiveOptions options_;
  BuildOptions build_;
  MapOptions map_options_;
  std::unique_ptr<OccupancyMap> map_;  ///< nullptr: SLAM has it
  ChangedPages changes_;
  std::unique_ptr<LiveSource> source_;
  std::optional<LiveNavigation> nav_;
  std::optional<ObstacleSender> obstacles_;
  std::optional<Ros2Publisher> publisher_;
  MapState published_;
  BeamQueue queue_;  ///< maps into map_
  std::vector<std::filesystem::path> recordings_;
  EventTracker events_;
  std::vector<Beam> arrived_;
  std::vector<Beam> new_beams_;  ///< for take_changes
  std::size_t beams_of_maps_before_ = 0;
  std::optional<double> last_beam_s_;  ///< when it arrived
  double newest_beam_s_ = 0.0;         ///< its stamp
  bool has_ended_ = false, has_nav_failed_ = false;
};

Result<LiveMapping> LiveMapping::open(const LiveOptions& options, Clock clock, const KeepWaiting& keep_waiting) {
  return detail::without_exceptions([&]() -> Result<LiveMapping> {
    if (const Result<void> valid = options.validate(); !valid) return tl::unexpected(valid.error());
    const Result<std::optional<Ros2Node>> node = node_of(options);
    if (!node) return tl::unexpected(node.error());
    if (*node && options.head.kind == LiveHead::Kind::kRos2) {
      // Before the clock starts, by which the other devices are late.
      const Result<void> published = wait_for_ros2_topic(**node, options.head.address, keep_waiting);
      if (!published) return tl::unexpected(published.error());
    }
    Clock since_start = started(std::move(clock));
    const std::uint64_t start_ms = since_1970_ms();
    Result<std::optional<std::filesystem::path>> record = record_path(options, start_ms);
    if (!record) return tl::unexpected(record.error());
    Recordings recordings(*std::move(record));
    Result<std::unique_ptr<LiveSource>> source = open_head(options.head, recordings, start_ms, *node);
    if (!source) return tl::unexpected(source.error());
    std::optional<LiveNavigation> nav;
    constexpr double kMs_per_s = 1000.0;
    const double start_s = static_cast<double>(start_ms) / kMs_per_s;
    if (!options.nav.empty()) {
      auto opened = LiveNavigation::open(options.nav, recordings, start_s, *node);
      if (!opened) return tl::unexpected(opened.error());
      nav = *std::move(opened);
    }
    const bool is_replay = options.head.kind == LiveHead::Kind::kReplay;
    BuildOptions build = options.build;
    build.model = options.beam.apply_to(build.model, (*source)->device());
    MapOptions map_options = options.map;
    if (!options.known_map) map_options.resolution_m = resolution_of(options, build);
    Result<MapperAndMap> mapper = open_mapper(options, build, map_options);
    if (!mapper) return tl::unexpected(mapper.error());
    Result<std::optional<Ros2Publisher>> publisher = publisher_of(options, *node, nav);
    if (!publisher) return tl::unexpected(publisher.error());
    return LiveMapping(std::make_unique<Run>(
        options,
        Run::Parts{std::move(since_start), is_replay ? 0.0 : start_s, start_s, *std::move(source), std::move(nav),
                   *std::move(publisher), build, map_options, *std::move(mapper), recordings.keep()}));
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

std::optional<StampedPose> LiveMapping::pose() const {
  return run_->pose();
}

LiveChanges LiveMapping::take_changes() {
  return run_->take_changes();
}

const LiveHead& LiveMapping::head() const {
  return run_->head();
}

const BuildOptions& LiveMapping::build() const {
  return run_->build();
}

Result<void> LiveMapping::drive(const LiveHead& head) {
  return run_->drive(head);
}

Result<void> LiveMapping::begin_recording() {
  return detail::without_exceptions([&] { return run_->begin_recording(); });
}

void LiveMapping::end_recording() {
  run_->end_recording();
}

bool LiveMapping::is_recording() const {
  return run_->is_recording();
}

Result<OccupancyMap> LiveMapping::begin_new_map() {
  return detail::without_exceptions([&] { return run_->begin_new_map(); });
}

std::vector<LiveEvent> LiveMapping::take_events() {
  return run_->take_events();
}

double LiveMapping::take_latency_s() {
  return run_->take_latency_s();
}

}  // namespace pingvox
