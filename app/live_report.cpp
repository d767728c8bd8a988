#include "live_report.hpp"

#include <fmt/format.h>

#include <string_view>

#include "base/words.hpp"
#include "evaluation_text.hpp"
#include "live/internal/motion_name.hpp"
#include "map_report.hpp"
#include "pingvox/geometry/degree.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

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
  if (slam.located) {
    const PoseHypothesis& where = *slam.located;
    JsonObject located;
    located.add("x_m", where.x_m)
        .add("y_m", where.y_m)
        .add("yaw_deg", where.yaw_rad / kDegree_rad)
        .add("sd_m", where.deviation_m)
        .add("sd_deg", where.deviation_rad / kDegree_rad);
    json.add("located", located);
  } else {
    json.add_null("located");
  }
  json.add("without_velocity_s", round_to_us(slam.without_velocity_s)).add("deviation_m", slam.deviation_m);
  json.add("loops", slam.loops).add("corrections", slam.corrections).add_truth("correcting", slam.is_correcting);
  return json;
}

std::string slam_line(const LiveSlamStatus& slam) {
  const std::string by =
      slam.by ? fmt::format("motion from {} and {}, standard deviation {:.3f} m after 1 s",
                            on_one_line(slam.by->velocity), on_one_line(slam.by->heading), slam.by->deviation_m_sqrt_s)
              : "no pose found";
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

std::string status_line(const LiveMapping& live, const LiveStatus& status, const LiveRates& rates) {
  const HeadStatus& head = status.head;
  return fmt::format("{}{} beams, {:.0f}/s, {} echoes, {} lost, {} not mapped, latency {:.0f} ms, map {}",
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
      report_line("received", fmt::format("{}; {} not mapped", beams_text(status.beams, report.sweeps, report.echoes),
                                          status.not_mapped)) +
      report_line("line", fmt::format("{} unanswered, {} damaged, {} unexpected, {}", head.unanswered, head.damaged,
                                      head.unexpected, counted(head.connections, "connection")));
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
