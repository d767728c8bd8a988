#include <fmt/chrono.h>
#include <fmt/core.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <deque>
#include <filesystem>
#include <future>
#include <new>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "json.hpp"
#include "live_navigation.hpp"
#include "map_report.hpp"
#include "pingvox/device/live_source.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/mavlink_obstacles.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "pingvox/mapping/obstacle_sectors.hpp"
#include "progress.hpp"
#include "stop_signals.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// When the beams' clock was 0.
struct Start {
  double s = 0.0;                   ///< of the stopwatch
  std::uint64_t since_1970_ms = 0;  ///< the same as a date
};

/// Ping Viewer's name for a log, "20261123-175346123", in local time.
std::string name_by_time(const Start& start) {
  const auto seconds = static_cast<std::time_t>(start.since_1970_ms / 1000);
  std::tm local = {};
  ::localtime_r(&seconds, &local);
  return fmt::format("{:%Y%m%d-%H%M%S}{:03}", local, start.since_1970_ms % 1000);
}

/// The file to record the sonar to; nullopt: none.
std::optional<std::filesystem::path> record_path(const LiveCommand& command, const Start& start) {
  if (!command.record) return std::nullopt;
  std::filesystem::path path = *command.record;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    path /= name_by_time(start) + (command.device.kind == LiveDevice::Kind::kMicron ? ".csv" : ".bin");
  }
  return path;
}

template <class Recorder>
Result<std::optional<Recorder>> recorder_of(const std::optional<std::filesystem::path>& record, const Start& start) {
  if (!record) return std::nullopt;
  return Recorder::create(record->string(), start.since_1970_ms).map([](Recorder created) {
    return std::optional(std::move(created));
  });
}

/// @param record  nullopt: none
Result<std::unique_ptr<LiveSource>> source_of(const LiveCommand& command,
                                              const std::optional<std::filesystem::path>& record, const Start& start) {
  const LiveDevice& device = command.device;
  if (device.kind == LiveDevice::Kind::kReplay) {
    return ByteStream::open(device.address)
        .and_then([](ByteStream stream) { return open_beams(std::move(stream)); })
        .map([&](std::unique_ptr<BeamSource> log) { return replay_source(std::move(log), device.speed); });
  }
  if (device.kind == LiveDevice::Kind::kMicron) {
    return recorder_of<SeanetRecorder>(record, start).map([&](std::optional<SeanetRecorder> recorder) {
      return micron_source(device.address, command.micron, std::move(recorder), start.s);
    });
  }
  return recorder_of<PingViewerRecorder>(record, start).map([&](std::optional<PingViewerRecorder> recorder) {
    return ping360_source(device.address, command.ping360, std::move(recorder), start.s);
  });
}

/// Sends the nearest obstacles to an autopilot.
class ObstacleSender {
 public:
  static Result<ObstacleSender> open(const std::string& address, const ObstacleOptions& options) {
    return Link::open(address).map([&](Link link) { return ObstacleSender(std::move(link), options); });
  }

  double due_s() const { return due_s_; }

  /// @param map_from_body  nullopt: not known
  void send(const OccupancyMap& map, const std::optional<Pose>& map_from_body, double now_s) {
    constexpr double kEvery_s = 0.2;
    constexpr std::uint8_t kObstacleAvoidance = 196;  // a component
    due_s_ = now_s + kEvery_s;
    if (!map_from_body) return;
    const ObstacleDistance message = message_of(nearest_obstacles(map, *map_from_body, options_));
    const MavlinkSender sender = {.sequence = sequence_++, .component = kObstacleAvoidance};
    // An autopilot that is not there is sent the next one.
    static_cast<void>(link_.write(make_mavlink_frame(kObstacleDistance, payload_of(message), sender)));
  }

 private:
  ObstacleSender(Link link, const ObstacleOptions& options) : link_(std::move(link)), options_(options) {}

  ObstacleDistance message_of(const ObstacleSectors& obstacles) const {
    const auto cm_of = [](double metres) { return static_cast<std::uint16_t>(std::lround(metres * 100.0)); };
    ObstacleDistance message;
    message.time_us = static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
            .count());
    message.min_cm = cm_of(options_.min_range_m);
    message.max_cm = cm_of(options_.max_range_m);
    std::ranges::transform(obstacles.sectors, message.cm.begin(), [&](const ObstacleSectors::Sector& sector) {
      using What = ObstacleSectors::What;
      if (sector.what == What::kObstacle) return cm_of(sector.range_m);
      return sector.what == What::kClear ? static_cast<std::uint16_t>(message.max_cm + 1) : ObstacleDistance::kUnknown;
    });
    return message;
  }

  Link link_;
  ObstacleOptions options_;
  double due_s_ = 0.0;
  std::uint8_t sequence_ = 0;
};

/// Writes maps in a thread of its own: a disk may take seconds, in which the lines' buffers would overflow.
class MapWriter {
 public:
  explicit MapWriter(const LiveCommand& command) : command_(command) {}

  /// Writes a copy of the map, unless the last one is still being written.
  /// @return error of the last one, or kNoMemory or kIo when this one cannot be begun
  Result<void> write(const OccupancyMap& map) {
    Result<void> last;
    if (written_.valid()) {
      if (written_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return {};
      last = written_.get();
    }
    try {
      written_ = std::async(std::launch::async, [this, copy = map] {
        return write_map(copy, command_.format, command_.made_by, command_.output);
      });
    } catch (const std::bad_alloc&) {
      return fail(Error::Code::kNoMemory, fmt::format("{}: not written: out of memory for a copy", command_.output));
    } catch (const std::system_error& error) {
      return fail(Error::Code::kIo, fmt::format("{}: not written: no thread: {}", command_.output, error.what()));
    }
    return last;
  }

  /// Writes the last map. @return its error
  Result<void> finish(const OccupancyMap& map) {
    if (written_.valid()) written_.wait();
    return write_map(map, command_.format, command_.made_by, command_.output);
  }

 private:
  const LiveCommand& command_;
  std::future<Result<void>> written_;
};

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
        if (const auto read = nav_->step(watch.seconds()); !read) {
          note(read.error());
          has_ended = true;
        }
      }
      queue_arrived(watch.seconds());
      if (can_map_one()) map_one(watch);
      report_changes();
      const double now_s = watch.seconds();
      if (obstacles_ && now_s >= obstacles_->due_s()) obstacles_->send(map_, last_pose(), now_s);
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

  /// The latest one that is known.
  std::optional<Pose> last_pose() const {
    if (!nav_) return Pose::Identity();
    const std::optional<double> until_s = nav_->poses().known_until_s();
    return until_s ? nav_->poses().at(*until_s) : std::nullopt;
  }

  /// The oldest beams are dropped when too many wait: the record has them.
  void queue_arrived(double now_s) {
    constexpr std::size_t kMaxWaiting = 2000;  // at most 2.4 MB of a Ping360
    for (Beam& beam : arrived_) {
      ++beams_;
      waiting_.push_back({std::move(beam), now_s});
    }
    arrived_.clear();
    for (; waiting_.size() > kMaxWaiting; waiting_.pop_front()) ++unmapped_;
  }

  void map_one(const Stopwatch& watch) {
    auto [beam, arrived_s] = std::move(waiting_.front());
    waiting_.pop_front();
    if (cannot_map_) {
      ++unmapped_;
      return;
    }
    const std::optional<Pose> pose = nav_ ? nav_->poses().at(beam.time_s) : Pose::Identity();
    if (const auto added = mapper_.add(std::move(beam), pose); !added) {
      cannot_map_ = true;
      note(added.error());
    }
    recent_.latency_s = std::max(recent_.latency_s, watch.seconds() - arrived_s);
  }

  Result<int> finish(const Stopwatch& watch) {
    source_->finish(arrived_);
    queue_arrived(watch.seconds());
    while (!waiting_.empty()) map_one(watch);
    if (!cannot_map_) {
      if (const auto finished = mapper_.finish(); !finished) note(finished.error());
    }
    report_changes();
    if (has_mapped()) {
      if (const auto written = writer_.finish(map_); !written) return tl::unexpected(written.error());
    } else if (!cannot_map_) {
      note({Error::Code::kIo, fmt::format("{}: not written: no beam was mapped", command_.output)});
    }
    bar_.clear();
    const LiveStatus status = source_->status();
    const auto printed = command_.output_options.report == Report::kJson
                             ? console_.print(json_of(watch.seconds(), true).text() + "\n")
                             : console_.summarise(text_of(status), command_.output);
    if (!printed) return tl::unexpected(printed.error());
    return has_failed_ ? 1 : 0;
  }

  void note(const Error& error) {
    bar_.clear();
    print_error(error.message);
    has_failed_ = true;
  }

  void report_changes() {
    const LiveStatus status = source_->status();
    report_recording_error(status.recording_error, was_recording_error_reported_);
    if (nav_) {
      for (std::size_t i = 0; i < reported_.size(); ++i) report_changes(nav_->devices()[i], reported_[i]);
      report_sources();
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
    note({error->code, fmt::format("{}: the recording ended; mapping goes on", error->message)});
  }

  /// The state of a navigation device that was printed last.
  struct Reported {
    bool recording_error = false, is_connected = false;
    std::string problem;
  };

  void report_changes(const NavDevice& device, Reported& last) {
    const NavDevice::Status status = device.status();
    report_recording_error(status.recording_error, last.recording_error);
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
      console_.say(fmt::format("{}: no attitude and position yet, {} messages so far: beams are not mapped",
                               nav_->names(), nav_->messages()));
    }
    if (were_sources_reported_ || poses.position().empty()) return;
    were_sources_reported_ = true;
    bar_.clear();
    console_.say(fmt::format("{}: attitude of {}, position of {}", nav_->names(), on_one_line(poses.attitude()),
                             on_one_line(poses.position())));
  }

  void report(double now_s) {
    const double beams_per_s = static_cast<double>(beams_ - recent_.first_beam) / (now_s - recent_.since_s);
    if (command_.output_options.report == Report::kJson) {
      // A reader that has gone ends nothing.
      static_cast<void>(console_.print(json_of(now_s, false).text() + "\n"));
    }
    const LiveStatus status = source_->status();
    bar_.draw(std::nullopt,
              fmt::format("{}{} beams, {:.0f}/s, {} echoes, {} lost, {} not mapped, {:.0f} ms late, map {}",
                          status.is_connected ? "" : "not connected, ", beams_, beams_per_s, mapper_.report().echoes,
                          status.unanswered + status.damaged, unmapped_, 1e3 * recent_.latency_s,
                          bytes_text(map_.memory_bytes())));
    recent_ = {now_s, beams_, 0.0};
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
        .add("not_mapped", unmapped_)
        .add("latency_ms", round_to_us(1e3 * recent_.latency_s))
        .add("unanswered", status.unanswered)
        .add("damaged", status.damaged)
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
      json.add("messages", status.messages)
          .add("damaged", status.damaged)
          .add_truth("recording_failed", status.recording_error.has_value());
      devices.add(device.name(), json);
    }
    JsonObject json;
    json.add("attitude", navigation.poses().attitude())
        .add("position", navigation.poses().position())
        .add("without_pose", mapper_.report().no_pose.count)
        .add("devices", devices);
    return json;
  }

  std::string text_of(const LiveStatus& status) const {
    const BuildReport& report = mapper_.report();
    std::string text =
        (has_mapped() ? on_one_line(command_.output) : "no map") + "\n" +
        report_line("heard", fmt::format("{}; {} not mapped", beams_text(beams_, report.sweeps, report.echoes),
                                         unmapped_ + report.skipped)) +
        report_line("line", fmt::format("{} unanswered, {} damaged, {}", status.unanswered, status.damaged,
                                        counted(status.connections, "connection")));
    if (nav_) {
      text += report_line("nav", fmt::format("{} messages, {} damaged; {} beams without a pose", nav_->messages(),
                                             nav_->damaged(), report.no_pose.count));
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
  std::size_t beams_ = 0, unmapped_ = 0;
  Recent recent_;
  bool cannot_map_ = false, has_failed_ = false;
  bool was_connected_ = false, was_recording_error_reported_ = false;
  bool were_sources_reported_ = false, was_silence_reported_ = false;
  std::string last_problem_;
  std::vector<Reported> reported_;  ///< of the devices of navigation
};

}  // namespace

Result<int> run(const LiveCommand& command, Console& console) {
  Result<StopSignals> signals = StopSignals::make();
  if (!signals) return tl::unexpected(signals.error());
  const Stopwatch watch;
  Result<OccupancyMap> map = OccupancyMap::make(command.map);
  if (!map) return tl::unexpected(map.error());
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  const auto since_1970_ms = std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
  const Start start{watch.seconds(), static_cast<std::uint64_t>(since_1970_ms)};
  const std::optional<std::filesystem::path> record = record_path(command, start);
  Result<std::unique_ptr<LiveSource>> source = source_of(command, record, start);
  if (!source) return tl::unexpected(source.error());
  std::optional<Navigation> nav;
  if (!command.nav.empty()) {
    Result<Navigation> opened =
        Navigation::open(command.nav, record, start.s, static_cast<double>(start.since_1970_ms) / 1000.0);
    if (!opened) return tl::unexpected(opened.error());
    nav = *std::move(opened);
    for (const NavDevice& device : nav->devices()) {
      if (device.listens()) console.say(fmt::format("{}: listening", device.name()));
    }
  }
  const BuildOptions options = command.head.apply_to(command.build, (*source)->device());
  Result<BeamMapper> mapper = BeamMapper::make(options, *map);
  if (!mapper) return tl::unexpected(mapper.error());
  std::optional<ObstacleSender> obstacles;
  if (command.obstacles) {
    Result<ObstacleSender> opened = ObstacleSender::open(*command.obstacles, {.max_range_m = command.ping360.range_m});
    if (!opened) return tl::unexpected(opened.error());
    obstacles = *std::move(opened);
  }
  return LiveRun(command, console, std::move(*source), std::move(nav), std::move(obstacles), std::move(*mapper), *map)
      .run(*signals, watch);
}

}  // namespace pingvox::app
