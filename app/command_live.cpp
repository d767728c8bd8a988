#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "json.hpp"
#include "live_navigation.hpp"
#include "live_sonar.hpp"
#include "map_report.hpp"
#include "map_writer.hpp"
#include "obstacle_sender.hpp"
#include "pingvox/device/live_source.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "progress.hpp"
#include "recordings.hpp"
#include "step_report.hpp"
#include "stop_signals.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// One run: receives beams, queues and maps them.
class LiveRun {
 public:
  LiveRun(const LiveCommand& command, Console& console, std::unique_ptr<LiveSource> source,
          std::optional<Navigation> nav, std::optional<ObstacleSender> obstacles, BeamMapper mapper, OccupancyMap& map)
      : command_(command),
        console_(console),
        source_(std::move(source)),
        nav_(std::move(nav)),
        obstacles_(std::move(obstacles)),
        mapper_(std::move(mapper)),
        map_(map),
        writer_(command),
        bar_(command.output_options),
        reported_(nav_ ? nav_->devices().size() : 0) {}

  Result<int> run(StopSignals& signals, const Stopwatch& watch) {
    double report_at_s = watch.seconds() + kReport_s, write_at_s = watch.seconds() + command_.write_every_s;
    bool has_ended = false;
    while (!has_ended && !signals.has_arrived() && (command_.max_beams == 0 || beams_ < command_.max_beams)) {
      const double next_s =
          std::min({report_at_s, write_at_s, source_->due_s(), obstacles_ ? obstacles_->due_s() : report_at_s});
      wait(signals, can_map_one() ? 0.0 : next_s - watch.seconds());
      const Result<bool> goes_on = source_->step(watch.seconds(), arrived_);
      // What was mapped until then is written all the same.
      if (!goes_on) note(goes_on.error());
      has_ended = !goes_on || !*goes_on;
      if (nav_) {
        // The recording of the sonar goes on.
        const auto read = nav_->step(watch.seconds());
        if (!read && !std::exchange(was_nav_error_reported_, true)) note(read.error());
      }
      queue_arrived(watch.seconds());
      map_some(watch);
      report_changes();
      const double now_s = watch.seconds();
      if (obstacles_ && now_s >= obstacles_->due_s()) obstacles_->send(map_, pose_for_obstacles(now_s), now_s);
      if (now_s >= report_at_s) {
        report(now_s);
        report_at_s = now_s + kReport_s;
      }
      if (now_s >= write_at_s) {
        if (has_mapped()) {
          if (const auto written = writer_.write(map_); !written) note(written.error());
        }
        write_at_s = now_s + command_.write_every_s;
      }
    }
    return finish(watch);
  }

 private:
  static constexpr double kReport_s = 1.0, kLong_s = 5.0;
  static constexpr double kMapping_s = 0.01;  ///< between two looks at the lines, or one beam

  struct Waiting {
    Beam beam;
    double arrived_s;
  };
  /// Since the last status.
  struct Recent {
    double since_s = 0.0;
    std::size_t first_beam = 0;
    double latency_s = 0.0;  ///< longest time from a beam's last byte until the mapper was done with it
  };

  void wait(const StopSignals& signals, double seconds) const {
    // poll() passes over -1.
    std::vector<pollfd> files = {{signals.descriptor(), POLLIN, 0}, {source_->descriptor(), POLLIN, 0}};
    if (nav_) {
      for (const NavDevice& device : nav_->devices()) files.push_back({device.descriptor(), POLLIN, 0});
    }
    ::poll(files.data(), files.size(), static_cast<int>(std::ceil(std::clamp(seconds, 0.0, kReport_s) * 1000.0)));
  }

  bool can_map_one() const {
    return !waiting_.empty() && !(nav_ && !cannot_map_ && nav_->may_come(waiting_.front().beam.time_s));
  }

  /// Without a beam there is no map, and an older one stays.
  bool has_mapped() const { return mapper_.report().beams > 0; }

  /// The latest one that is known. nullopt: it, or the last beam, is too old to say where obstacles are.
  std::optional<Pose> pose_for_obstacles(double now_s) const {
    constexpr double kOldest_s = 2.0;
    if (cannot_map_ || !last_beam_s_ || now_s - *last_beam_s_ > kLong_s) return std::nullopt;
    if (!nav_) return Pose::Identity();
    const std::optional<double> until_s = nav_->poses().known_until_s();
    return until_s && nav_->now_s() - *until_s <= kOldest_s ? nav_->poses().at(*until_s) : std::nullopt;
  }

  /// Beams without a pose are known before the mapper leaves them out, which is at the end of their sweep. Those that
  /// reach out of the map are mapped in part.
  std::size_t not_mapped() const {
    const BuildReport& report = mapper_.report();
    return dropped_ + without_pose_ + report.blocked.count + report.too_long.count;
  }

  /// Beams that are not yet mapped.
  std::size_t waiting() const { return beams_ - mapper_.report().beams - not_mapped(); }

  /// The oldest beams are dropped when too many wait: the record has them.
  void queue_arrived(double now_s) {
    constexpr std::size_t kMaxWaiting = 2000;  // at most 2.4 MB of a Ping360
    for (Beam& beam : arrived_) {
      ++beams_;
      last_beam_s_ = now_s;
      waiting_.push_back({std::move(beam), now_s});
    }
    arrived_.clear();
    for (; waiting_.size() > kMaxWaiting; waiting_.pop_front()) ++dropped_;
  }

  void map_some(const Stopwatch& watch) {
    for (const double until_s = watch.seconds() + kMapping_s; can_map_one();) {
      map_one(watch);
      if (watch.seconds() >= until_s) return;
    }
  }

  /// Beams that the mapper held are lost with an error.
  void give_up_mapping(const Error& error) {
    cannot_map_ = true;
    dropped_ += waiting() - waiting_.size();
    note(error);
  }

  void map_one(const Stopwatch& watch) {
    auto [beam, arrived_s] = std::move(waiting_.front());
    waiting_.pop_front();
    if (cannot_map_) {
      ++dropped_;
      return;
    }
    const std::optional<Pose> pose = nav_ ? nav_->poses().at(beam.time_s) : Pose::Identity();
    if (!pose) ++without_pose_;
    if (const auto added = mapper_.add(std::move(beam), pose); !added) give_up_mapping(added.error());
    recent_.latency_s = std::max(recent_.latency_s, watch.seconds() - arrived_s);
  }

  Result<int> finish(const Stopwatch& watch) {
    source_->finish(arrived_);
    queue_arrived(watch.seconds());
    while (!waiting_.empty()) map_one(watch);
    if (!cannot_map_) {
      if (const auto finished = mapper_.finish(); !finished) give_up_mapping(finished.error());
    }
    report_changes();
    if (has_mapped()) {
      if (const auto written = writer_.finish(map_); !written) note(written.error());
    } else if (!cannot_map_) {
      note({Error::Code::kIo, fmt::format("{}: not written: no beam was mapped", command_.output)});
    }
    bar_.clear();
    const LiveStatus status = source_->status();
    const auto printed = command_.output_options.report == Report::kJson
                             ? console_.print(json_of(watch.seconds(), true).text() + "\n")
                             : console_.summarise(text_of(status), command_.output);
    if (!printed) note(printed.error());
    if (has_mapped() && map_.empty()) console_.say(empty_map_text(command_.output));
    return has_failed_ ? 1 : 0;
  }

  void note(const Error& error) {
    bar_.clear();
    console_.say_error(error.message);
    has_failed_ = true;
  }

  void report_changes() {
    const LiveStatus status = source_->status();
    report_recording_error(status.recording_error, was_recording_error_reported_);
    if (status.unexpected > 0 && !std::exchange(was_unexpected_reported_, true)) {
      bar_.clear();
      console_.say(fmt::format("{}: a beam that was not asked for: {}; such beams are recorded and not mapped",
                               command_.device.text, status.first_unexpected));
    }
    if (obstacles_ && obstacles_->problem() != last_obstacle_problem_) {
      last_obstacle_problem_ = obstacles_->problem();
      bar_.clear();
      console_.say(last_obstacle_problem_.empty()
                       ? fmt::format("obstacles: {} is known now", *command_.obstacles)
                       : fmt::format("obstacles: not sent ({}); trying again", last_obstacle_problem_));
    }
    if (nav_) {
      for (std::size_t i = 0; i < reported_.size(); ++i) report_changes(nav_->devices()[i], reported_[i]);
      report_sources();
      report_new_frames();
    }
    if (status.is_connected == was_connected_ && status.problem == last_problem_) return;
    bar_.clear();
    const std::string& name = command_.device.text;
    const bool is_replay = command_.device.kind == LiveDevice::Kind::kReplay;
    if (status.is_connected && !is_replay) console_.say(fmt::format("{}: connected", name));
    if (!status.is_connected && !status.problem.empty()) {
      console_.say(fmt::format("{}: not connected ({}); trying again", name, status.problem));
    }
    was_connected_ = status.is_connected;
    last_problem_ = status.problem;
  }

  void report_recording_error(const std::optional<Error>& error, bool& was_reported) {
    if (!error || was_reported) return;
    was_reported = true;
    note({error->code, fmt::format("{}; mapping goes on", error->message)});
  }

  /// The state of a navigation device that was printed last.
  struct Reported {
    bool recording_error = false, is_connected = false, has_other_origin = false;
    std::string problem;
    std::size_t vehicles = 0, others = 0;
  };

  /// Prints who is followed, where several send.
  void report_senders(const NavDevice& device, const NavDevice::Status& status, Reported& last) {
    if (status.vehicles > last.vehicles && last.vehicles > 0) {
      bar_.clear();
      console_.say(
          fmt::format("{}: follows {} now: who was followed before fell silent; if it is another vehicle, start a "
                      "new map",
                      device.name(), status.vehicle));
    }
    last.vehicles = status.vehicles;
    last.others = std::min(last.others, status.others.size());
    for (; last.others < status.others.size(); ++last.others) {
      bar_.clear();
      console_.say(
          fmt::format("{}: ignores {}, as it follows {}", device.name(), status.others[last.others], status.vehicle));
    }
  }

  void report_changes(const NavDevice& device, Reported& last) {
    const NavDevice::Status status = device.status();
    report_recording_error(status.recording_error, last.recording_error);
    report_senders(device, status, last);
    const std::string& position = nav_->poses().position();
    if (device.has_other_origin(position) && !std::exchange(last.has_other_origin, true)) {
      bar_.clear();
      console_.say(
          fmt::format("{}: the sender of {} was started anew: its positions are relative to another origin "
                      "now; start a new map",
                      device.name(), on_one_line(position)));
    }
    if (device.listens() || (status.is_connected == last.is_connected && status.problem == last.problem)) return;
    bar_.clear();
    console_.say(status.is_connected
                     ? fmt::format("{}: connected", device.name())
                     : fmt::format("{}: not connected ({}); trying again", device.name(), status.problem));
    last.is_connected = status.is_connected;
    last.problem = status.problem;
  }

  /// Prints which sources give the poses once they are chosen, or that they are missing for long.
  void report_sources() {
    const LivePoses& poses = nav_->poses();
    if (poses.position().empty() && nav_->now_s() > kLong_s && !was_silence_reported_) {
      was_silence_reported_ = true;
      bar_.clear();
      const bool has_attitude = poses.has(NavQuantity::kAttitude), has_position = poses.has(NavQuantity::kPosition);
      const std::string_view missing = has_attitude == has_position ? "attitude and position"
                                       : has_attitude               ? "position"
                                                                    : "attitude";
      console_.say(fmt::format("{}: no {} yet, {} messages so far: beams are not mapped", nav_->names(), missing,
                               nav_->messages()));
    }
    if (poses.position().empty()) return;
    report_silence(poses);
    if (were_sources_reported_) return;
    were_sources_reported_ = true;
    bar_.clear();
    console_.say(fmt::format("{}: attitude of {}, position of {}", nav_->names(), on_one_line(poses.attitude()),
                             on_one_line(poses.position())));
  }

  /// Prints when the origin of a source was set anew: what is mapped from then on does not fit to what was.
  void report_new_frames() {
    constexpr std::size_t kMaxReported = 20;  // who sends nonsense shall not fill the screen
    for (const LivePoses::NewFrame& frame : nav_->take_new_frames()) {
      if (++new_frames_ > kMaxReported) continue;
      bar_.clear();
      console_.say(fmt::format("{}: {} of {} {}: it is in another frame now; start a new map", nav_->names(),
                               name_of(frame.quantity), on_one_line(frame.source), step_text(frame.step)));
    }
  }

  /// Prints when the poses end, and when they come again.
  void report_silence(const LivePoses& poses) {
    const std::optional<double> until_s = poses.known_until_s();
    const bool is_silent = !until_s || nav_->now_s() - *until_s > kLong_s;
    if (is_silent == has_no_pose_) return;
    has_no_pose_ = is_silent;
    bar_.clear();
    console_.say(is_silent ? fmt::format("{}: no pose for {} s: beams are not mapped", nav_->names(), kLong_s)
                           : fmt::format("{}: poses again", nav_->names()));
  }

  void report(double now_s) {
    const double beams_per_s = static_cast<double>(beams_ - recent_.first_beam) / (now_s - recent_.since_s);
    // A reader that has gone, or has stopped reading, ends nothing.
    if (command_.output_options.report == Report::kJson) console_.offer(json_of(now_s, false).text() + "\n");
    bar_.draw(std::nullopt, status_line(beams_per_s));
    recent_ = {now_s, beams_, 0.0};
  }

  std::string status_line(double beams_per_s) const {
    const LiveStatus status = source_->status();
    return fmt::format("{}{} beams, {:.0f}/s, {} echoes, {} lost, {} not mapped, {:.0f} ms late, map {}",
                       status.is_connected ? "" : "not connected, ", beams_, beams_per_s, mapper_.report().echoes,
                       status.unanswered + status.damaged + status.unexpected, not_mapped(), 1e3 * recent_.latency_s,
                       bytes_text(map_.memory_bytes()));
  }

  JsonObject json_of(double now_s, bool is_last) const {
    const LiveStatus status = source_->status();
    JsonObject json;
    json.add_truth("done", is_last)
        .add("time_s", round_to_us(now_s))
        .add_truth("connected", status.is_connected)
        .add("connections", status.connections)
        .add("beams", beams_)
        .add("mapped", mapper_.report().beams)
        .add("echoes", mapper_.report().echoes)
        .add("not_mapped", not_mapped())
        .add("waiting", waiting())
        .add("latency_ms", round_to_us(1e3 * recent_.latency_s))
        .add("unanswered", status.unanswered)
        .add("damaged", status.damaged)
        .add("unexpected", status.unexpected)
        .add_truth("recording_failed", status.recording_error.has_value())
        .add("memory_bytes", map_.memory_bytes());
    if (nav_) {
      json.add("nav", json_of(*nav_));
    } else {
      json.add_null("nav");
    }
    return json;
  }

  JsonObject json_of(const Navigation& navigation) const {
    JsonObject devices;
    for (const NavDevice& device : navigation.devices()) {
      const NavDevice::Status status = device.status();
      JsonObject json;
      if (!device.listens()) json.add_truth("connected", status.is_connected).add("connections", status.connections);
      if (device.listens())
        json.add("vehicle", status.vehicle)
            .add("ignored", status.ignored)
            .add("others", fmt::format("{}", fmt::join(status.others, ", ")));
      json.add("messages", status.messages)
          .add("damaged", status.damaged)
          .add_truth("recording_failed", status.recording_error.has_value());
      devices.add(device.name(), json);
    }
    JsonObject json;
    json.add("attitude", navigation.poses().attitude())
        .add("position", navigation.poses().position())
        .add("without_pose", without_pose_)
        .add("outliers", navigation.poses().outliers())
        .add("new_origins", new_frames_)
        .add("devices", devices);
    return json;
  }

  std::string text_of(const LiveStatus& status) const {
    const BuildReport& report = mapper_.report();
    std::string text =
        (has_mapped() ? on_one_line(command_.output) : "no map") + "\n" +
        report_line("heard",
                    fmt::format("{}; {} not mapped", beams_text(beams_, report.sweeps, report.echoes), not_mapped())) +
        report_line("line", fmt::format("{} unanswered, {} damaged, {} not as asked for, {}", status.unanswered,
                                        status.damaged, status.unexpected, counted(status.connections, "connection")));
    if (nav_) {
      text += report_line("nav", fmt::format("{} messages, {} damaged; {} beams without a pose", nav_->messages(),
                                             nav_->damaged(), without_pose_));
    }
    return has_mapped() ? text + map_text(map_, map_.counts()) : text;
  }

  const LiveCommand& command_;
  Console& console_;
  std::unique_ptr<LiveSource> source_;
  std::optional<Navigation> nav_;  ///< nullopt: the vehicle stands still
  std::optional<ObstacleSender> obstacles_;
  BeamMapper mapper_;
  OccupancyMap& map_;
  MapWriter writer_;
  ProgressBar bar_;
  std::vector<Beam> arrived_;
  std::deque<Waiting> waiting_;
  std::size_t beams_ = 0, without_pose_ = 0;
  std::size_t new_frames_ = 0;  ///< of positions, depths and attitudes, by which the map does not fit any more
  std::size_t dropped_ = 0;     ///< dropped under load, or after an error of the map
  Recent recent_;
  bool cannot_map_ = false, has_failed_ = false;
  bool was_connected_ = false, was_recording_error_reported_ = false, was_unexpected_reported_ = false;
  bool was_nav_error_reported_ = false;
  bool were_sources_reported_ = false, was_silence_reported_ = false, has_no_pose_ = false;
  std::optional<double> last_beam_s_;  ///< when it arrived
  std::string last_problem_, last_obstacle_problem_;
  std::vector<Reported> reported_;  ///< of the devices of navigation
};

}  // namespace

Result<int> run(const LiveCommand& command, Console& console) {
  // A terminal that is stopped must not stop the head.
  console.never_wait();
  Result<StopSignals> signals = StopSignals::make();
  if (!signals) return tl::unexpected(signals.error());
  const Stopwatch watch;
  Result<OccupancyMap> map = OccupancyMap::make(command.map);
  if (!map) return tl::unexpected(map.error());
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  const auto since_1970_ms = std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
  const LiveStart start{watch.seconds(), static_cast<std::uint64_t>(since_1970_ms)};
  Result<std::optional<std::filesystem::path>> record = record_path(command, start);
  if (!record) return tl::unexpected(record.error());
  Recordings recordings(*std::move(record));
  Result<std::unique_ptr<LiveSource>> source = open_live_sonar(command, recordings, start);
  if (!source) return tl::unexpected(source.error());
  std::optional<Navigation> nav;
  if (!command.nav.empty()) {
    Result<Navigation> opened =
        Navigation::open(command.nav, recordings, start.s, static_cast<double>(start.since_1970_ms) / 1000.0);
    if (!opened) return tl::unexpected(opened.error());
    nav = *std::move(opened);
    for (const NavDevice& device : nav->devices()) {
      if (device.listens()) console.say(fmt::format("{}: listening", device.name()));
    }
  }
  BuildOptions options = command.build;
  options.model = command.head.apply_to(command.build.model, (*source)->device());
  Result<BeamMapper> mapper = BeamMapper::make(options, *map);
  if (!mapper) return tl::unexpected(mapper.error());
  std::optional<ObstacleSender> obstacles;
  if (command.obstacles) {
    obstacles.emplace(*command.obstacles, ObstacleOptions{.max_range_m = command.ping360.range_m});
  }
  for (const std::filesystem::path& file : recordings.keep()) console.say("recording to " + file.string());
  return LiveRun(command, console, std::move(*source), std::move(nav), std::move(obstacles), std::move(*mapper), *map)
      .run(*signals, watch);
}

}  // namespace pingvox::app
