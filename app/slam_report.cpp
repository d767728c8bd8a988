#include "slam_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "io/internal/json.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "pingvox/geometry/degree.hpp"
#include "recording_report.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

double to_degrees(double angle_rad) {
  return angle_rad / kDegree_rad;
}

JsonObject estimate_json(const Estimate& estimate, double unit = 1.0) {
  JsonObject json;
  return json.add("value", estimate.value / unit).add("sd", estimate.deviation / unit);
}

JsonObject calibration_json(const SlamCalibration& calibration) {
  std::vector<JsonObject> headings;
  for (const HeadingCalibration& heading : calibration.headings) {
    headings.emplace_back()
        .add("source", heading.source)
        .add("constant_deg", estimate_json(heading.constant_rad, kDegree_rad))
        .add("sin1_deg", estimate_json(heading.sin1_rad, kDegree_rad))
        .add("cos1_deg", estimate_json(heading.cos1_rad, kDegree_rad))
        .add("sin2_deg", estimate_json(heading.sin2_rad, kDegree_rad))
        .add("cos2_deg", estimate_json(heading.cos2_rad, kDegree_rad));
  }
  JsonObject json;
  return json.add("velocity_yaw_deg", estimate_json(calibration.velocity_yaw_rad, kDegree_rad))
      .add("velocity_scale", estimate_json(calibration.velocity_scale))
      .add("wall_in_echo", estimate_json(calibration.wall_in_echo))
      .add("sonar_x_m", estimate_json(calibration.sonar_x_m))
      .add("sonar_y_m", estimate_json(calibration.sonar_y_m))
      .add("headings", headings);
}

double recorded_s(const SlamSolution& solution) {
  const auto& poses = solution.trajectory.poses();
  return poses.back().time_s - poses.front().time_s;
}

/// How well the poses are known.
struct Uncertainty {
  double mean_m = 0.0;    ///< mean of the standard deviations along the direction that is known least
  PlaceEllipse greatest;  ///< and at which time
  double greatest_at_s = 0.0, greatest_yaw_rad = 0.0;
};

/// nullopt: it was not estimated.
std::optional<Uncertainty> uncertainty_of(const SlamSolution& solution) {
  if (solution.covariances.empty()) return std::nullopt;
  Uncertainty all;
  for (const PoseCovariance& pose : solution.covariances) {
    const PlaceEllipse place = place_ellipse(pose.covariance);
    all.mean_m += place.along_m / static_cast<double>(solution.covariances.size());
    all.greatest_yaw_rad = std::max(all.greatest_yaw_rad, std::sqrt(pose.covariance(2, 2)));
    if (place.along_m <= all.greatest.along_m) continue;
    all.greatest = place;
    all.greatest_at_s = pose.time_s;
  }
  return all;
}

JsonObject json_of(const Uncertainty& all) {
  JsonObject greatest, json;
  greatest.add("at_s", all.greatest_at_s)
      .add("along_m", all.greatest.along_m)
      .add("across_m", all.greatest.across_m)
      .add("direction_deg", to_degrees(all.greatest.direction_rad));
  return json.add("mean_sd_m", all.mean_m)
      .add("greatest_sd", greatest)
      .add("greatest_yaw_sd_deg", to_degrees(all.greatest_yaw_rad));
}

JsonObject json_of(const SlamSeconds& seconds) {
  JsonObject json;
  return json.add("read", round_to_us(seconds.read))
      .add("solve", round_to_us(seconds.solve))
      .add("map", round_to_us(seconds.map))
      .add("write", round_to_us(seconds.write))
      .add("total", round_to_us(seconds.total));
}

/// Rounded, and 0 instead of -0.
double hundredths(double value) {
  return std::round(value * 100.0) / 100.0 + 0.0;
}

std::string degrees_text(const Estimate& estimate) {
  return fmt::format("{:.2f} +- {:.2f}", hundredths(to_degrees(estimate.value)), to_degrees(estimate.deviation));
}

std::string title_of(const SlamCommand& command) {
  return command.output == "-" ? "standard output\n" : on_one_line(command.output) + "\n";
}

std::string seconds_text(const SlamSeconds& seconds) {
  return fmt::format("{:.3f} = {:.3f} read + {:.3f} solve + {:.3f} map + {:.3f} write + rest", seconds.total,
                     seconds.read, seconds.solve, seconds.map, seconds.write);
}

JsonObject json_of(const LoopCount& loops) {
  JsonObject json;
  json.add("found", loops.found).add("kept", loops.kept);
  return json;
}

JsonObject json_of(const LargestSolution& largest) {
  JsonObject json;
  json.add("knots", largest.knots).add("echoes", largest.echoes).add("pairs", largest.pairs);
  return json;
}

std::string velocity_text(const VelocityReport& velocity, std::size_t sweeps) {
  if (const auto& sonar = velocity.by_sonar) {
    return fmt::format(
        "not measured, but by the sonar: {} of {} sweeps match those before them, longest gap {:.0f} s; "
        "without pairs it drifts by {:.1f} m",
        sonar->matched, sweeps, velocity.longest_gap_s, sonar->drift_m);
  }
  const std::string check = velocity.check
                                ? fmt::format("{:.2f} m/s from what the sonar sees", velocity.check->difference_m_s)
                                : std::string("not checked by the sonar");
  const std::string by_sonar = velocity.gaps_by_sonar_s > 0.0
                                   ? fmt::format(" ({:.0f} s of gaps by the sonar)", velocity.gaps_by_sonar_s)
                                   : std::string();
  return fmt::format("{}, {} samples, {} clipped, longest gap {:.2f} s{}; {}", on_one_line(velocity.source),
                     velocity.samples, velocity.clipped, velocity.longest_gap_s, by_sonar, check);
}

std::string sensors_text(const SlamSolution& solution) {
  const SlamCalibration& c = solution.calibration;
  std::string text;
  if (!solution.report.velocity.by_sonar) {
    text = fmt::format("velocity turned by {} degrees, scaled by {:.4f} +- {:.4f}; ", degrees_text(c.velocity_yaw_rad),
                       1.0 + c.velocity_scale.value, c.velocity_scale.deviation);
  }
  return text + fmt::format("sonar moved by {:.2f} {:.2f} m; wall at {:.2f} in its echo (-1: first bin, 1: last)",
                            hundredths(c.sonar_x_m.value), hundredths(c.sonar_y_m.value),
                            hundredths(c.wall_in_echo.value));
}

/// The harmonics of a heading are one name: "sin1 of heading IMU" and so on are its deviation.
std::string not_known_text(const std::vector<std::string>& names) {
  std::vector<std::string> shown;
  for (const std::string& name : names) {
    const bool is_harmonic = name.starts_with("sin") || name.starts_with("cos");
    std::string text = is_harmonic ? "deviation" + name.substr(name.find(' ')) : name;
    if (std::ranges::find(shown, text) == shown.end()) shown.push_back(std::move(text));
  }
  return on_one_line(fmt::format("{}: hardly observable in this recording", fmt::join(shown, ", ")));
}

}  // namespace

std::string slam_json(const Recording& recording, const RecordingSlam& slam, const SlamCommand& command,
                      const SlamInputs& inputs, const SlamSeconds& seconds) {
  const SlamSolution& solution = slam.solution;
  const SlamReport& report = solution.report;
  JsonObject velocity, json;
  velocity.add("source", report.velocity.source)
      .add("samples", report.velocity.samples)
      .add("clipped", report.velocity.clipped)
      .add("longest_gap_s", report.velocity.longest_gap_s)
      .add("gaps_by_sonar_s", report.velocity.gaps_by_sonar_s);
  if (const auto& motion = report.velocity.by_sonar) {
    JsonObject by_sonar;
    by_sonar.add("matched", motion->matched)
        .add("noise_m_sqrt_s", motion->noise_m_sqrt_s)
        .add("drift_m", motion->drift_m);
    velocity.add("by_sonar", by_sonar);
  } else {
    velocity.add_null("by_sonar");
  }
  if (const auto& checked = report.velocity.check) {
    JsonObject check;
    check.add("sweeps", checked->sweeps).add("difference_m_s", checked->difference_m_s);
    velocity.add("check", check);
  } else {
    velocity.add_null("check");
  }
  json.add("poses", solution.trajectory.poses().size())
      .add("in_pauses", report.in_pauses)
      .add("beams", report.beams)
      .add("sweeps", report.sweeps)
      .add("echoes", report.echoes)
      .add("skipped", slam.skipped)
      .add("sound_speed_m_s", slam.options.sound_speed_ratio * kAssumedSoundSpeed_m_s)
      .add("knots", report.knots)
      .add("pairs", report.pairs.count)
      .add("pair_median_m", report.pairs.median_m)
      .add("loops", json_of(report.pairs.loops))
      .add("submap_loops", json_of(report.pairs.submap_loops))
      .add("velocity", velocity)
      .add("heading", report.heading)
      .add("frame", frame_text(slam))
      .add("nav_clock", json_of(*recording.nav_offset()))
      .add("nav_logs", nav_logs_json(recording.nav().clocks))
      .add("nav_others", json_of(inputs.others));
  report.clock_check ? json.add("clock_check", json_of(*report.clock_check)) : json.add_null("clock_check");
  report.largest ? json.add("largest", json_of(*report.largest)) : json.add_null("largest");
  std::vector<JsonObject> not_observable;
  for (const std::string& what : report.not_observable) not_observable.emplace_back().add("name", what);
  json.add("not_observable", not_observable);
  std::vector<JsonObject> implausible;
  for (const std::string& what : report.implausible) implausible.emplace_back().add("name", what);
  json.add("implausible", implausible);
  const std::optional<Uncertainty> uncertainty = uncertainty_of(solution);
  uncertainty ? json.add("uncertainty", json_of(*uncertainty)) : json.add_null("uncertainty");
  if (command.slam.matching == Matching::kPairs) {
    json.add("calibration", calibration_json(solution.calibration));
  } else {
    json.add_null("calibration");
  }
  if (inputs.mapped) {
    JsonObject mapped;
    json.add("map", mapped.add("beams", inputs.mapped->beams)
                        .add("skipped", inputs.mapped->skipped)
                        .add("resolution", inputs.mapped->resolution_m));
  } else {
    json.add_null("map");
  }
  json.add("recorded_s", recorded_s(solution)).add("seconds", json_of(seconds));
  json.add("real_time_factor", recorded_s(solution) / seconds.total);
  return json.text() + "\n";
}

std::string slam_text(const Recording& recording, const RecordingSlam& slam, const SlamCommand& command,
                      const SlamInputs& inputs, const SlamSeconds& seconds) {
  const SlamSolution& solution = slam.solution;
  const SlamReport& report = solution.report;
  std::string text = title_of(command);
  std::string read = beams_text(report.beams, report.sweeps, report.echoes);
  if (slam.skipped > 0) read += fmt::format("; skipped {}", counted(slam.skipped, "damaged record"));
  text += report_line("read", read);
  text += report_line("nav clock", app::text_of(*recording.nav_offset(), report.clock_check));
  text += nav_logs_text(recording.nav().clocks);
  text += recording.water() ? report_line("water", water_text(*recording.water()))
                            : sound_line(slam.options.sound_speed_ratio * kAssumedSoundSpeed_m_s);
  text += report_line("velocity", velocity_text(report.velocity, report.sweeps)) + others_line(inputs.others);
  const std::size_t poses = solution.trajectory.poses().size();
  std::string trajectory = fmt::format("{} over {:.1f} s", counted(poses, "pose"), recorded_s(solution));
  if (report.in_pauses > 0) trajectory += fmt::format(", {} of them in pauses of the sonar", report.in_pauses);
  const std::size_t of_beams = poses - report.in_pauses;
  if (of_beams < report.beams) trajectory += fmt::format("; {} without one", counted(report.beams - of_beams, "beam"));
  if (const std::size_t gaps = solution.trajectory.gaps(); gaps > 0) trajectory += ", " + counted(gaps, "gap");
  text += report_line("trajectory", trajectory);
  text += report_line("frame", frame_text(slam));
  if (command.slam.matching == Matching::kPairs) {
    text +=
        report_line("pairs", report.pairs.count == 0 ? "none: the poses come from velocity and headings alone"
                                                     : fmt::format("{}, median distance {:.2f} m, {} of {} loops kept",
                                                                   report.pairs.count, report.pairs.median_m,
                                                                   report.pairs.loops.kept, report.pairs.loops.found));
    if (const LoopCount& loops = report.pairs.submap_loops; loops.found > 0) {
      text += report_line("submaps", fmt::format("{} of {} loops kept before", loops.kept, loops.found));
    }
    text += report_line("sensors", sensors_text(solution));
    for (const HeadingCalibration& heading : solution.calibration.headings) {
      text +=
          report_line("heading", fmt::format("{}: constant {}, deviation {:.2f} and {:.2f} degrees",
                                             on_one_line(heading.source), degrees_text(heading.constant_rad),
                                             to_degrees(std::hypot(heading.sin1_rad.value, heading.cos1_rad.value)),
                                             to_degrees(std::hypot(heading.sin2_rad.value, heading.cos2_rad.value))));
    }
  }
  if (const auto all = uncertainty_of(solution)) {
    text += report_line(
        "uncertain",
        fmt::format("{:.2f} m in the mean; at {:.1f} s {:.2f} m along {:.0f} degrees from east and "
                    "{:.2f} m across; yaw {:.2f} degrees",
                    all->mean_m, all->greatest_at_s, all->greatest.along_m, to_degrees(all->greatest.direction_rad),
                    all->greatest.across_m, to_degrees(all->greatest_yaw_rad)));
  }
  if (!report.not_observable.empty()) {
    text += report_line("not known", not_known_text(report.not_observable));
  }
  if (inputs.mapped) text += report_line("cells", inputs.mapped->resolution);
  return text + report_line("seconds", fmt::format("{}; {:.0f} times real time", seconds_text(seconds),
                                                   recorded_s(solution) / seconds.total));
}

std::string scan_slam_json(const ScanSlamReport& report, std::size_t skipped, const SlamSeconds& seconds) {
  JsonObject loops, json;
  loops.add("found", report.loops_found).add("kept", report.loops_kept);
  json.add("poses", report.scans)
      .add("scans", report.scans)
      .add("skipped", skipped)
      .add("key_frames", report.key_frames)
      .add("reach_m", report.reach_m)
      .add("rounds", report.rounds)
      .add("loops", loops)
      .add("seconds", json_of(seconds));
  return json.text() + "\n";
}

std::string scan_slam_text(const ScanSlamReport& report, const SlamCommand& command, const SlamSeconds& seconds) {
  return title_of(command) +
         report_line("read", fmt::format("{} scans, {} key frames, reach {:.3g} m", report.scans, report.key_frames,
                                         report.reach_m)) +
         report_line(
             "loops",
             report.loops_kept == 0
                 ? fmt::format("none of {} kept: the poses are those of the odometry", report.loops_found)
                 : fmt::format("{} of {} kept after {} rounds", report.loops_kept, report.loops_found, report.rounds)) +
         report_line("seconds", seconds_text(seconds));
}

}  // namespace pingvox::app
