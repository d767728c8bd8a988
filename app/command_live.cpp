#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "evaluation_text.hpp"
#include "head_control.hpp"
#include "io/internal/json.hpp"
#include "live_event_text.hpp"
#include "live_report.hpp"
#include "map_report.hpp"
#include "open_browser.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/live/map_writer.hpp"
#include "pingvox/web/live_view.hpp"
#include "pingvox/web/page.hpp"
#include "pingvox/web/server.hpp"
#include "progress.hpp"
#include "stop_signals.hpp"

namespace pingvox::app {
namespace {

/// A message about options, for a page that has none.
std::string without_dashes(std::string text) {
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at)) text.erase(at, 2);
  return text;
}

/// Pushes a LiveMapping, writes its map, and prints what happens.
class LiveRun {
 public:
  /// @param view  nullopt: none
  LiveRun(const LiveCommand& command, Console& console, LiveMapping live, std::optional<web::LiveView> view)
      : command_(command),
        console_(console),
        live_(std::move(live)),
        view_(std::move(view)),
        writer_(command.output, command.format, command.made_by),
        bar_(command.output_options) {}

  Result<int> run(const StopSignals& signals) {
    double report_at_s = live_.time_s() + kReport_s, write_at_s = live_.time_s() + command_.write_every_s;
    bool goes_on = true;
    while (goes_on && !signals.has_arrived() && (command_.max_beams == 0 || live_.beams() < command_.max_beams)) {
      const double view_at_s = view_ ? view_->due_s() : report_at_s;
      live_.wait(std::min({report_at_s, write_at_s, view_at_s}) - live_.time_s(), signals.descriptor());
      const Result<bool> stepped = live_.step();
      goes_on = stepped && *stepped;
      report_events();
      if (view_) update_view();
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

  void update_view() {
    for (const web::LiveControl& control : view_->take_controls()) {
      const Result<void> done = std::visit([this](const auto& wanted) { return execute(wanted); }, control);
      if (!done) show("refused: " + without_dashes(done.error().message));
    }
    latency_s_ = std::max(latency_s_, live_.take_latency_s());
    view_->update(live_, latency_s_);
  }

  Result<void> execute(const web::live_control::DriveHead& control) {
    LiveHead head = live_.head();
    const Result<void> valid = apply(control, head);
    const Result<void> driven = valid ? live_.drive(head) : valid;
    if (driven) show("the new settings of the head apply from its next request on");
    return driven;
  }
  Result<void> execute(const web::live_control::BeginRecording&) {
    if (!command_.live.record) return fail(Error::Code::kBadOption, "give --record FOLDER to record");
    const std::size_t before = live_.recordings().size();
    const Result<void> begun = live_.begin_recording();
    if (begun) show("recording to " + live_.recordings()[before].string());
    return begun;
  }
  Result<void> execute(const web::live_control::EndRecording&) {
    const std::string file = live_.recordings().empty() ? "" : live_.recordings().back().string();
    live_.end_recording();
    show(file.empty() ? "recording ended" : fmt::format("recording {} ended", file));
    return {};
  }
  Result<void> execute(const web::live_control::BeginNewMap&) {
    const bool has_old = has_mapped();
    const Result<OccupancyMap> old = live_.begin_new_map();
    if (!old) return tl::unexpected(old.error());
    has_new_map_ = true;
    if (!has_old || old->empty() || command_.output.starts_with("/dev/")) return {};
    const std::string file = free_name(command_.output);
    old_maps_.emplace_back(file, command_.format, command_.made_by);
    show(fmt::format("new map; the previous one is {}", file));
    return old_maps_.back().write(*old);
  }

  /// "dive-1.bt" beside "dive.bt".
  static std::string free_name(const std::string& path) {
    const std::filesystem::path output = path;
    for (int number = 1;; ++number) {
      std::filesystem::path file = output;
      file.replace_filename(fmt::format("{}-{}{}", output.stem().string(), number, output.extension().string()));
      std::error_code error;
      if (!std::filesystem::exists(file, error)) return file.string();
    }
  }

  void show(const std::string& text) {
    bar_.clear();
    console_.say(text);
    if (view_) view_->tell(text);
  }

  Result<int> finish() {
    const Result<void> finished = live_.finish();
    if (!finished) note(finished.error());
    report_events();
    if (has_mapped()) {
      if (const auto written = writer_.finish(live_.map()); !written) note(written.error());
    } else if (!has_mapping_failed_ && finished && !has_new_map_) {
      note({Error::Code::kIo, fmt::format("{}: not written: no beam was mapped", command_.output)});
    }
    if (command_.poses) {
      if (const auto written = write_path(*command_.poses); !written) note(written.error());
    }
    bar_.clear();
    const LiveStatus status = live_.status();
    const LiveRates rates = {.latency_s = take_latency_s()};
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
      const std::string text = live_event_text(event, command_.live, live_.status());
      if (const Error* const error = error_of(event)) {
        note({error->code, text});
        if (view_) view_->tell(text);
      } else {
        show(text);
      }
    }
  }

  /// Since the last report.
  double take_latency_s() { return std::max(std::exchange(latency_s_, 0.0), live_.take_latency_s()); }

  void report(double now_s) {
    const LiveStatus status = live_.status();
    const LiveRates rates = {static_cast<double>(status.beams - reported_beams_) / (now_s - reported_s_),
                             take_latency_s()};
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
  std::optional<web::LiveView> view_;
  MapWriter writer_;
  std::deque<MapWriter> old_maps_;
  ProgressBar bar_;
  double reported_s_ = 0.0;
  std::size_t reported_beams_ = 0;
  std::size_t new_frames_ = 0;
  double latency_s_ = 0.0;  ///< since the last report
  bool has_mapping_failed_ = false, has_failed_ = false, has_new_map_ = false;
};

/// A page and its server, which goes before the page.
struct ServedView {
  web::LiveView view;
  web::Server server;
};

/// Prints the address of the page first.
Result<ServedView> serve(const LiveCommand& command, const LiveMapping& live, const web::Page& page, Console& console) {
  const bool is_north_up = std::ranges::any_of(
      command.live.nav, [](const LiveNav& device) { return device.kind == LiveNav::Kind::kMavlink; });
  Result<web::LiveView> view = web::LiveView::make(
      live, page, {.title = command.output, .axes = is_north_up ? MapAxes::kEastNorth : MapAxes::kUnknown});
  if (!view) return tl::unexpected(view.error());
  Result<web::Server> server = web::Server::start(view->responder(), {.address = command.view->address,
                                                                      .port = command.view->port,
                                                                      .readers = command.readers,
                                                                      .token = web::WantToken::kForControl});
  if (!server) return tl::unexpected(server.error());
  const bool is_json = command.output_options.report == Report::kJson;
  const auto printed =
      console.print(is_json ? JsonObject().add("view", server->url()).text() + "\n" : server->url() + "\n");
  if (!printed) return tl::unexpected(printed.error());
  console.say("open this address in a browser; Ctrl-C ends");
  return ServedView{*std::move(view), *std::move(server)};
}

}  // namespace

Result<int> run(const LiveCommand& command, Console& console) {
  std::optional<web::Page> page;
  if (command.view) {
    const Result<web::Page> built = page_of_build("live");
    if (!built) return tl::unexpected(built.error());
    page = *built;
  }
  // A terminal that is stopped must not stop the head.
  console.never_wait();
  Result<StopSignals> signals = StopSignals::make();
  if (!signals) return tl::unexpected(signals.error());
  std::string told;
  const auto keep_waiting = [&](const std::string& problem) {
    if (problem != told) console.say(problem + "; waiting");
    told = problem;
    return !signals->has_arrived();
  };
  Result<LiveMapping> live = LiveMapping::open(command.live, nullptr, keep_waiting);
  if (!live) return tl::unexpected(live.error());
  for (const LiveNavStatus& device : live->status().nav) {
    if (device.kind == LiveNav::Kind::kMavlink) console.say(fmt::format("{}: listening", device.name));
  }
  for (const std::filesystem::path& file : live->recordings()) console.say("recording to " + file.string());
  std::optional<web::Server> server;
  std::optional<web::LiveView> view;
  if (page) {
    Result<ServedView> served = serve(command, *live, *page, console);
    if (!served) return fail(served.error().code, "live: " + served.error().message);
    view = std::move(served->view);
    server = std::move(served->server);
  }
  LiveRun run(command, console, *std::move(live), std::move(view));
  const Result<int> status = run.run(*signals);
  // Before the view that answers its requests.
  server.reset();
  return status;
}

}  // namespace pingvox::app
