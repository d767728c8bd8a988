#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "evaluation_text.hpp"
#include "live_report.hpp"
#include "map_report.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/live/map_writer.hpp"
#include "progress.hpp"
#include "stop_signals.hpp"

namespace pingvox::app {
namespace {

/// Pushes a LiveMapping, writes its map, and prints what happens.
class LiveRun {
 public:
  LiveRun(const LiveCommand& command, Console& console, LiveMapping live)
      : command_(command),
        console_(console),
        live_(std::move(live)),
        writer_(command.output, command.format, command.made_by),
        bar_(command.output_options) {}

  Result<int> run(const StopSignals& signals) {
    double report_at_s = live_.time_s() + kReport_s, write_at_s = live_.time_s() + command_.write_every_s;
    bool goes_on = true;
    while (goes_on && !signals.has_arrived() && (command_.max_beams == 0 || live_.beams() < command_.max_beams)) {
      live_.wait(std::min(report_at_s, write_at_s) - live_.time_s(), signals.descriptor());
      const Result<bool> stepped = live_.step();
      goes_on = stepped && *stepped;
      report_events();
      // What was mapped until then is written all the same.
      if (!stepped) note(stepped.error());
      const double now_s = live_.time_s();
      if (now_s >= report_at_s) {
        report(now_s);
        report_at_s = now_s + kReport_s;
      }
      if (now_s >= write_at_s) {
        if (has_mapped()) {
          if (const auto written = writer_.write(live_.map()); !written) note(written.error());
        }
        write_at_s = now_s + command_.write_every_s;
      }
    }
    return finish();
  }

 private:
  static constexpr double kReport_s = 1.0;

  /// Without a beam there is no map, and an older one stays.
  bool has_mapped() const { return live_.report().beams > 0; }

  Result<int> finish() {
    const Result<void> finished = live_.finish();
    if (!finished) note(finished.error());
    report_events();
    if (has_mapped()) {
      if (const auto written = writer_.finish(live_.map()); !written) note(written.error());
    } else if (!has_mapping_failed_ && finished) {
      note({Error::Code::kIo, fmt::format("{}: not written: no beam was mapped", command_.output)});
    }
    if (command_.poses) {
      if (const auto written = write_path(*command_.poses); !written) note(written.error());
    }
    bar_.clear();
    const LiveStatus status = live_.status();
    const LiveRates rates = {.latency_s = live_.take_latency_s()};
    const auto printed = command_.output_options.report == Report::kJson
                             ? console_.print(live_json(live_, status, rates, LiveEnd::kYes).text() + "\n")
                             : console_.summarise(live_summary(live_, status, command_), command_.output);
    if (!printed) note(printed.error());
    if (has_mapped() && live_.map().empty()) console_.say(empty_map_text(command_.output));
    for (const std::string& warning : coverage_warnings(live_.coverage())) {
      console_.say(fmt::format("{}: {}", command_.output, warning));
    }
    return has_failed_ ? 1 : 0;
  }

  Result<void> write_path(const std::string& file) {
    const std::optional<Trajectory> path = live_.path();
    if (!path) return fail(Error::Code::kIo, fmt::format("{}: not written: no pose is known", file));
    // Dated as the recording, to go with it.
    std::vector<StampedPose> poses = path->poses();
    for (StampedPose& pose : poses) pose.time_s += live_.since_1970_s();
    const Result<Trajectory> dated = Trajectory::make(std::move(poses));
    if (!dated) return tl::unexpected(dated.error());
    return write_file(file, [&](std::ostream& out) { return write_tum(*dated, out); });
  }

  void note(const Error& error) {
    bar_.clear();
    console_.say_error(error.message);
    has_failed_ = true;
  }

  void report_events() {
    constexpr std::size_t kMaxNewFrames = 20;  // who sends nonsense shall not fill the screen
    for (const LiveEvent& event : live_.take_events()) {
      if (std::holds_alternative<live_event::MappingFailed>(event)) has_mapping_failed_ = true;
      if (std::holds_alternative<live_event::NewFrame>(event) && ++new_frames_ > kMaxNewFrames) continue;
      const std::string text = text_of(event, command_, live_.status());
      if (const Error* const error = error_of(event)) {
        note({error->code, text});
      } else {
        bar_.clear();
        console_.say(text);
      }
    }
  }

  void report(double now_s) {
    const LiveStatus status = live_.status();
    const LiveRates rates = {static_cast<double>(status.beams - reported_beams_) / (now_s - reported_s_),
                             live_.take_latency_s()};
    // A reader that has gone, or has stopped reading, ends nothing.
    if (command_.output_options.report == Report::kJson) {
      console_.offer(live_json(live_, status, rates, LiveEnd::kNo).text() + "\n");
    }
    bar_.draw(std::nullopt, status_line(live_, status, rates));
    reported_s_ = now_s;
    reported_beams_ = status.beams;
  }

  const LiveCommand& command_;
  Console& console_;
  LiveMapping live_;
  MapWriter writer_;
  ProgressBar bar_;
  double reported_s_ = 0.0;
  std::size_t reported_beams_ = 0;
  std::size_t new_frames_ = 0;
  bool has_mapping_failed_ = false, has_failed_ = false;
};

}  // namespace

Result<int> run(const LiveCommand& command, Console& console) {
  // A terminal that is stopped must not stop the head.
  console.never_wait();
  Result<StopSignals> signals = StopSignals::make();
  if (!signals) return tl::unexpected(signals.error());
  Result<LiveMapping> live = LiveMapping::open(command.live);
  if (!live) return tl::unexpected(live.error());
  for (const LiveNavStatus& device : live->status().nav) {
    if (device.kind == LiveNav::Kind::kMavlink) console.say(fmt::format("{}: listening", device.name));
  }
  for (const std::filesystem::path& file : live->recordings()) console.say("recording to " + file.string());
  return LiveRun(command, console, *std::move(live)).run(*signals);
}

}  // namespace pingvox::app
