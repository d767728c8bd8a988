#include "live_report.hpp"

#include <fmt/format.h>

#include <string_view>

#include "base/words.hpp"
#include "evaluation_text.hpp"
#include "map_report.hpp"
#include "step_report.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// Names of the navigation devices.
std::string nav_names(const LiveStatus& status) {
  std::string names;
  for (const LiveNavStatus& device : status.nav) names += (names.empty() ? "" : ", ") + device.name;
  return names;
}

/// The text of each kind of event.
class EventText {
 public:
  EventText(const LiveCommand& command, const LiveStatus& status) : command_(command), status_(status) {}

  std::string operator()(const live_event::Connected& event) const {
    return fmt::format("{}: connected", event.device);
  }
  std::string operator()(const live_event::NotConnected& event) const {
    return fmt::format("{}: not connected ({}); trying again", event.device, event.reason);
  }
  std::string operator()(const live_event::RecordingFailed& event) const {
    return fmt::format("{}; mapping goes on", event.error.message);
  }
  std::string operator()(const live_event::MappingFailed& event) const { return event.error.message; }
  std::string operator()(const live_event::NavFailed& event) const { return event.error.message; }
  std::string operator()(const live_event::UnexpectedBeam& event) const {
    return fmt::format("{}: a beam that was not asked for: {}; such beams are recorded and not mapped", event.device,
                       event.reason);
  }
  std::string operator()(const live_event::SourcesChosen& event) const {
    return fmt::format("{}: attitude of {}, position of {}", nav_names(status_), on_one_line(event.attitude),
                       on_one_line(event.position));
  }
  std::string operator()(const live_event::NoSourceYet& event) const {
    const std::string_view missing = event.has_attitude == event.has_position ? "attitude and position"
                                     : event.has_attitude                     ? "position"
                                                                              : "attitude";
    return fmt::format("{}: no {} yet, {} messages so far: beams are not mapped", nav_names(status_), missing,
                       event.messages);
  }
  std::string operator()(const live_event::PosesEnded&) const {
    return fmt::format("{}: no pose for 5 s: beams are not mapped", nav_names(status_));
  }
  std::string operator()(const live_event::PosesResumed&) const {
    return fmt::format("{}: poses again", nav_names(status_));
  }
  std::string operator()(const live_event::VehicleChanged& event) const {
    return fmt::format(
        "{}: follows {} now: who was followed before fell silent; if it is another vehicle, start a new map",
        event.device, event.vehicle);
  }
  std::string operator()(const live_event::SenderIgnored& event) const {
    return fmt::format("{}: ignores {}, as it follows {}", event.device, event.sender, event.vehicle);
  }
  std::string operator()(const live_event::SenderRestarted& event) const {
    return fmt::format(
        "{}: the sender of {} restarted: its positions are relative to another origin now; start a new map",
        event.device, on_one_line(event.position));
  }
  std::string operator()(const live_event::NewFrame& event) const {
    return fmt::format("{}: {} of {} {}: it is in another frame now; start a new map", nav_names(status_),
                       name_of(event.quantity), on_one_line(event.source), step_text(event.step));
  }
  std::string operator()(const live_event::ObstaclesNotSent& event) const {
    return fmt::format("obstacles: not sent ({}); trying again", event.reason);
  }
  std::string operator()(const live_event::ObstaclesSent&) const {
    return fmt::format("obstacles: {} is known now", *command_.live.obstacles);
  }
  std::string operator()(const live_event::MotionChosen& event) const {
    const std::string heading =
        event.heading.empty() ? "the turn rates" : fmt::format("the heading of {}", on_one_line(event.heading));
    switch (event.motion) {
      case LiveMotion::kVelocity:
        return fmt::format(
            "slam: motion by the velocity of {} and {}{}", on_one_line(event.velocity), heading,
            event.deviation_m_sqrt_s ? fmt::format(", {:.3f} m off after a second", *event.deviation_m_sqrt_s) : "");
      case LiveMotion::kSonarAndHeading:
        return fmt::format("slam: no velocity: motion by the sonar and {}", heading);
      default:
        return "slam: no velocity and no heading: motion by the sonar alone";
    }
  }
  std::string operator()(const live_event::LoopClosed& event) const {
    return fmt::format("slam: a place is seen again: the path moves by up to {:.2f} m, and the map is corrected",
                       event.moved_m);
  }
  std::string operator()(const live_event::SlamFailed& event) const {
    return fmt::format("slam: {}; such beams are not mapped", event.error.message);
  }

 private:
  const LiveCommand& command_;
  const LiveStatus& status_;
};

std::string_view name_of(LiveMotion motion) {
  switch (motion) {
    case LiveMotion::kVelocity:
      return "velocity";
    case LiveMotion::kSonarAndHeading:
      return "sonar and heading";
    case LiveMotion::kSonar:
      return "sonar";
    default:
      return "not decided";
  }
}

JsonObject slam_json(const LiveSlamStatus& slam) {
  JsonObject json;
  json.add("motion", name_of(slam.motion));
  if (slam.by) {
    json.add("velocity", slam.by->velocity)
        .add("heading", slam.by->heading)
        .add("deviation_m_sqrt_s", slam.by->deviation_m_sqrt_s);
  } else {
    json.add_null("velocity").add_null("heading").add_null("deviation_m_sqrt_s");
  }
  json.add("loops", slam.loops).add("corrections", slam.corrections).add_truth("correcting", slam.is_correcting);
  return json;
}

std::string slam_line(const LiveSlamStatus& slam) {
  const std::string by =
      slam.by ? fmt::format("motion by {} and {}, {:.3f} m off after a second", on_one_line(slam.by->velocity),
                            on_one_line(slam.by->heading), slam.by->deviation_m_sqrt_s)
              : "no pose was found";
  return report_line("slam", fmt::format("{}; {}; map corrected {}", by, counted(slam.loops, "loop"),
                                         counted(slam.corrections, "time")));
}

bool listens(const LiveNavStatus& device) {
  return device.kind == LiveNav::Kind::kMavlink;
}

JsonObject nav_json(const LiveStatus& status) {
  JsonObject devices;
  for (const LiveNavStatus& device : status.nav) {
    JsonObject json;
    if (!listens(device)) json.add_truth("connected", device.is_connected).add("connections", device.connections);
    if (listens(device))
      json.add("vehicle", device.vehicle)
          .add("ignored", device.ignored)
          .add("others", fmt::format("{}", fmt::join(device.others, ", ")));
    json.add("messages", device.messages)
        .add("damaged", device.damaged)
        .add_truth("recording_failed", device.recording_error.has_value());
    devices.add(device.name, json);
  }
  JsonObject json;
  json.add("attitude", status.attitude)
      .add("position", status.position)
      .add("without_pose", status.without_pose)
      .add("outliers", status.outliers)
      .add("new_origins", status.new_frames)
      .add("devices", devices);
  return json;
}

}  // namespace

std::string text_of(const LiveEvent& event, const LiveCommand& command, const LiveStatus& status) {
  return std::visit(EventText(command, status), event);
}

std::string status_line(const LiveMapping& live, const LiveStatus& status, const LiveRates& rates) {
  const HeadStatus& head = status.head;
  return fmt::format("{}{} beams, {:.0f}/s, {} echoes, {} lost, {} not mapped, {:.0f} ms late, map {}",
                     head.is_connected ? "" : "not connected, ", status.beams, rates.beams_per_s, live.report().echoes,
                     head.unanswered + head.damaged + head.unexpected, status.not_mapped, 1e3 * rates.latency_s,
                     bytes_text(live.map().memory_bytes()));
}

JsonObject live_json(const LiveMapping& live, const LiveStatus& status, const LiveRates& rates, LiveEnd end) {
  const HeadStatus& head = status.head;
  JsonObject json;
  json.add_truth("done", end == LiveEnd::kYes)
      .add("time_s", round_to_us(status.time_s))
      .add_truth("connected", head.is_connected)
      .add("connections", head.connections)
      .add("beams", status.beams)
      .add("mapped", status.mapped)
      .add("echoes", live.report().echoes)
      .add("not_mapped", status.not_mapped)
      .add("waiting", status.waiting)
      .add("latency_ms", round_to_us(1e3 * rates.latency_s))
      .add("unanswered", head.unanswered)
      .add("damaged", head.damaged)
      .add("unexpected", head.unexpected)
      .add_truth("recording_failed", head.recording_error.has_value())
      .add("memory_bytes", live.map().memory_bytes())
      .add("resolution", live.map().lattice().resolution_m());
  if (status.nav.empty()) {
    json.add_null("nav");
  } else {
    json.add("nav", nav_json(status));
  }
  if (end == LiveEnd::kYes) {
    if (const SweepCoverage coverage = live.coverage(); coverage.sweeps > 0) {
      json.add("coverage", coverage_json(coverage));
    }
  }
  if (status.slam) {
    json.add("slam", slam_json(*status.slam));
  } else {
    json.add_null("slam");
  }
  return json;
}

std::string live_summary(const LiveMapping& live, const LiveStatus& status, const LiveCommand& command) {
  const BuildReport& report = live.report();
  const HeadStatus& head = status.head;
  const bool has_mapped = report.beams > 0;
  std::string text =
      (has_mapped ? on_one_line(command.output) : "no map") + "\n" +
      report_line("heard", fmt::format("{}; {} not mapped", beams_text(status.beams, report.sweeps, report.echoes),
                                       status.not_mapped)) +
      report_line("line", fmt::format("{} unanswered, {} damaged, {} not as asked for, {}", head.unanswered,
                                      head.damaged, head.unexpected, counted(head.connections, "connection")));
  if (!status.nav.empty()) {
    std::size_t messages = 0, damaged = 0;
    for (const LiveNavStatus& device : status.nav) {
      messages += device.messages;
      damaged += device.damaged;
    }
    text += report_line(
        "nav", fmt::format("{} messages, {} damaged; {} beams without a pose", messages, damaged, status.without_pose));
  }
  if (const SweepCoverage coverage = live.coverage(); coverage.sweeps > 0) {
    text += report_line("sweeps", movement_text(coverage)) + report_line("places", places_text(coverage));
  }
  if (status.slam) text += slam_line(*status.slam);
  return has_mapped ? text + map_text(live.map(), live.map().counts()) : text;
}

}  // namespace pingvox::app
