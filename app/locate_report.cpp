#include "locate_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <vector>

#include "io/internal/clock.hpp"
#include "io/internal/json.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

constexpr std::size_t kShown = 8;  ///< of a list

std::size_t smoothed_poses(const LocatedRecording& found) {
  return static_cast<std::size_t>(std::ranges::count(found.poses, true, &LocatedPose::is_smoothed));
}

/// When the pose was sure.
std::vector<TimeSpan> sure_spans(const LocatedRecording& found) {
  std::vector<TimeSpan> spans;
  bool was_sure = false;
  for (const LocatedPose& pose : found.poses) {
    if (pose.was_sure && !was_sure) spans.push_back({pose.time_s, pose.time_s});
    if (pose.was_sure) spans.back().to_s = pose.time_s;
    was_sure = pose.was_sure;
  }
  return spans;
}

JsonObject hypothesis_json(const PoseHypothesis& h) {
  JsonObject json;
  return json.add("x_m", h.x_m)
      .add("y_m", h.y_m)
      .add("yaw_deg", h.yaw_rad / kDegree_rad)
      .add("sd_m", h.deviation_m)
      .add("sd_deg", h.deviation_rad / kDegree_rad)
      .add("weight", h.weight);
}

std::string sure_text(const LocatedRecording& found) {
  const std::vector<TimeSpan> sure = sure_spans(found);
  if (sure.empty()) return "never";
  std::string text = found.is_sure() ? "at the end" : "not at the end";
  for (std::size_t i = 0; i < std::min(kShown, sure.size()); ++i) {
    text += fmt::format("{} {:.1f} to {:.1f}", i == 0 ? "; from" : ",", sure[i].from_s, sure[i].to_s);
  }
  text += " s";
  if (sure.size() > kShown) text += fmt::format(", and {} times more", sure.size() - kShown);
  return text;
}

double sound_speed_of(const RecordingLocation& location) {
  return location.options.localizer.sound_speed_ratio * kAssumedSoundSpeed_m_s;
}

/// What is known of the motion.
std::string motion_text(const Recording& recording, const RecordingLocation& location) {
  const RecordingOptions& options = recording.options();
  if (options.poses) {
    return fmt::format("{} of {}", counted(location.odometry_poses, "pose"), on_one_line(options.poses->name()));
  }
  if (options.nav.empty()) return "none: the vehicle is assumed to move little";
  const std::string heading = on_one_line(location.heading);
  return location.velocity.empty()
             ? fmt::format("heading of {}, no velocity: the vehicle is assumed to move little", heading)
             : fmt::format("velocity of {} along the heading of {}", on_one_line(location.velocity), heading);
}

}  // namespace

std::size_t unsure_poses(const LocatedRecording& found) {
  return static_cast<std::size_t>(std::ranges::count(found.poses, false, &LocatedPose::is_known));
}

std::string locate_json(const Recording& recording, const RecordingLocation& location, std::size_t written,
                        const LocateSeconds& seconds) {
  const LocatedRecording& found = location.found;
  std::vector<JsonObject> hypotheses, spans;
  for (const PoseHypothesis& h : found.hypotheses) hypotheses.push_back(hypothesis_json(h));
  const std::vector<TimeSpan> sure = sure_spans(found);
  for (const TimeSpan& span : sure) spans.emplace_back().add("from_s", span.from_s).add("to_s", span.to_s);
  JsonObject particles, took, json;
  particles.add("mean", found.mean_particles).add("max", found.most_particles);
  took.add("read", round_to_us(seconds.read))
      .add("field", round_to_us(location.field_s))
      .add("locate", round_to_us(location.locate_s))
      .add("total", round_to_us(seconds.total));
  json.add("poses", written)
      .add("unsure", unsure_poses(found))
      .add("smoothed", smoothed_poses(found))
      .add("beams", location.beams)
      .add("skipped", location.skipped)
      .add("sound_speed_m_s", sound_speed_of(location))
      .add("motion", motion_text(recording, location))
      .add("nav_others", json_of(location.others));
  const bool has_nav = !recording.options().nav.empty();
  has_nav ? json.add("nav_clock", json_of(*recording.nav_offset())) : json.add_null("nav_clock");
  json.add("nav_logs", nav_logs_json(recording.nav().clocks));
  found.clock_check ? json.add("clock_check", json_of(*found.clock_check)) : json.add_null("clock_check");
  json.add_truth("sure", found.is_sure()).add("hypotheses", hypotheses).add("sure_spans", spans);
  if (sure.empty()) {
    json.add_null("converged_at_s");
  } else {
    json.add("converged_at_s", sure.front().from_s);
  }
  json.add("particles", particles)
      .add("field_bytes", location.field_bytes)
      .add("recorded_s", location.recorded_s)
      .add("seconds", took);
  return json.text() + "\n";
}

std::string locate_text(const Recording& recording, const RecordingLocation& location, const LocateCommand& command,
                        std::size_t written, const LocateSeconds& seconds) {
  const LocatedRecording& found = location.found;
  std::string text = written == 0            ? "no trajectory is written\n"
                     : command.output == "-" ? "standard output\n"
                                             : on_one_line(command.output) + "\n";
  text += report_line("motion", motion_text(recording, location)) + others_line(location.others);
  if (!recording.options().nav.empty()) {
    text += report_line("nav clock", app::text_of(*recording.nav_offset(), found.clock_check)) +
            nav_logs_text(recording.nav().clocks);
  }
  text +=
      recording.water() ? report_line("water", water_text(*recording.water())) : sound_line(sound_speed_of(location));
  text += report_line("trajectory",
                      fmt::format("{} of {}, {} {}; {} smoothed; {:.0f} particles on average, {} at most",
                                  counted(written, "pose"), counted(location.beams, "beam"), unsure_poses(found),
                                  written == found.poses.size() ? "may be wrong" : "left out", smoothed_poses(found),
                                  found.mean_particles, found.most_particles));
  for (const PoseHypothesis& h : std::span(found.hypotheses).first(std::min(kShown, found.hypotheses.size()))) {
    text += report_line("at the end",
                        fmt::format("{:.3f} {:.3f} m +- {:.3f}, {:.1f} +- {:.1f} degrees, weight {:.3f}", h.x_m, h.y_m,
                                    h.deviation_m, h.yaw_rad / kDegree_rad, h.deviation_rad / kDegree_rad, h.weight));
  }
  if (found.hypotheses.size() > kShown) {
    text += report_line("at the end", fmt::format("and {}", counted(found.hypotheses.size() - kShown, "other place")));
  }
  text += report_line("sure", sure_text(found));
  return text +
         report_line("seconds", fmt::format("{:.3f} = {:.3f} read + {:.3f} distance field + {:.3f} locate + rest",
                                            seconds.total, seconds.read, location.field_s, location.locate_s));
}

}  // namespace pingvox::app
