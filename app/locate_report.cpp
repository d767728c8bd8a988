#include "locate_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <vector>

#include "json.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/clock.hpp"
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

}  // namespace

std::size_t unsure_poses(const LocatedRecording& found) {
  return static_cast<std::size_t>(std::ranges::count(found.poses, false, &LocatedPose::is_known));
}

std::string locate_json(const LocatedRecording& found, const LocateInputs& inputs, const LocateSeconds& seconds) {
  std::vector<JsonObject> hypotheses, spans;
  for (const PoseHypothesis& h : found.hypotheses) hypotheses.push_back(hypothesis_json(h));
  const std::vector<TimeSpan> sure = sure_spans(found);
  for (const TimeSpan& span : sure) spans.emplace_back().add("from_s", span.from_s).add("to_s", span.to_s);
  JsonObject particles, took, json;
  particles.add("mean", found.mean_particles).add("max", found.most_particles);
  took.add("read", round_to_us(seconds.read))
      .add("field", round_to_us(seconds.field))
      .add("locate", round_to_us(seconds.locate))
      .add("total", round_to_us(seconds.total));
  json.add("poses", inputs.written)
      .add("unsure", unsure_poses(found))
      .add("smoothed", smoothed_poses(found))
      .add("beams", inputs.beams)
      .add("skipped", inputs.skipped)
      .add("sound_speed_m_s", inputs.sound_speed_m_s)
      .add("motion", inputs.motion.text)
      .add("nav_others", inputs.motion.others.json());
  inputs.motion.clock ? json.add("nav_clock", json_of(*inputs.motion.clock)) : json.add_null("nav_clock");
  json.add("nav_logs", inputs.motion.clock ? nav_logs_json(*inputs.motion.clock) : std::vector<JsonObject>());
  found.clock_check ? json.add("clock_check", json_of(*found.clock_check)) : json.add_null("clock_check");
  json.add_truth("sure", found.is_sure()).add("hypotheses", hypotheses).add("sure_spans", spans);
  if (sure.empty()) {
    json.add_null("converged_at_s");
  } else {
    json.add("converged_at_s", sure.front().from_s);
  }
  json.add("particles", particles)
      .add("field_bytes", inputs.field_bytes)
      .add("recorded_s", inputs.recorded_s)
      .add("seconds", took);
  return json.text() + "\n";
}

std::string locate_text(const LocatedRecording& found, const LocateCommand& command, const LocateInputs& inputs,
                        const LocateSeconds& seconds) {
  const LocateMotion& motion = inputs.motion;
  std::string text = inputs.written == 0     ? "no trajectory is written\n"
                     : command.output == "-" ? "standard output\n"
                                             : on_one_line(command.output) + "\n";
  text += report_line("motion", motion.text) + others_line(motion.others);
  if (motion.clock) {
    text += report_line("nav clock", text_of(*motion.clock, found.clock_check)) + nav_logs_text(*motion.clock);
  }
  text += motion.water ? report_line("water", water_text(*motion.water)) : sound_line(inputs.sound_speed_m_s);
  text += report_line(
      "trajectory", fmt::format("{} of {}, {} {}; {} by all of the recording; {:.0f} particles on average, {} at most",
                                counted(inputs.written, "pose"), counted(inputs.beams, "beam"), unsure_poses(found),
                                inputs.written == found.poses.size() ? "may be wrong" : "left out",
                                smoothed_poses(found), found.mean_particles, found.most_particles));
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
                                            seconds.total, seconds.read, seconds.field, seconds.locate));
}

}  // namespace pingvox::app
