#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "calibration_file.hpp"
#include "commands.hpp"
#include "json.hpp"
#include "map_log.hpp"
#include "map_report.hpp"
#include "mapping_options.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "option_values.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/g2o.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/slam/scan_slam.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "progress.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// Beams of all logs, on the map and left out of it.
struct MappedBeams {
  std::size_t beams = 0, skipped = 0;
};

/// What was read besides beams, velocity and headings.
struct Inputs {
  NavOffset nav_offset;
  std::optional<Water> nav_water;     ///< by the navigation log, where it was asked
  std::size_t skipped = 0;            ///< records
  std::optional<MappedBeams> mapped;  ///< nullopt: there is no map
};

struct Seconds {
  double read = 0.0, solve = 0.0, map = 0.0, write = 0.0, total = 0.0;
};

Result<Log> open(const std::string& file, const SlamCommand& command) {
  return ByteStream::open(file).and_then(
      [&](ByteStream stream) { return open_log(std::move(stream), command.damage, std::nullopt, command.bag.beams); });
}

/// Opens a log of beams.
Result<std::unique_ptr<BeamSource>> open_beam_log(const std::string& file, const SlamCommand& command) {
  Result<Log> log = open(file, command);
  if (!log) return tl::unexpected(log.error());
  if (auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&*log)) return std::move(*beams);
  return fail(Error::Code::kUnsupported, fmt::format("{}: holds scans of points, not beams of a sonar", file));
}

/// The files that a solution is made of: "dive.csv, nav.csv"
std::string inputs_text(const SlamCommand& command) {
  std::string text = command.logs.front();
  for (const std::string& nav : command.navs) text += ", " + nav;
  return text;
}

struct Read {
  std::size_t beams = 0, skipped = 0;
};

/// Gives the smoother all beams and navigation.
/// @param first  the first log, opened
Result<Read> read_all(SlamSmoother& smoother, const NavFiles& nav, const SlamCommand& command,
                      std::unique_ptr<BeamSource> first) {
  if (const auto added = smoother.add(nav.log); !added) {
    return fail(added.error().code, fmt::format("{}: {}", fmt::join(command.navs, ", "), added.error().message));
  }
  Read read{.skipped = nav.damaged};
  for (const std::string& name : command.logs) {
    const auto log = first ? std::exchange(first, nullptr) : open_beam_log(name, command);
    if (!log) return tl::unexpected(log.error());
    for (;;) {
      Result<std::optional<Beam>> beam = (*log)->next();
      if (!beam) return tl::unexpected(beam.error());
      if (!*beam) break;
      smoother.add(std::move(**beam));
      ++read.beams;
    }
    read.skipped += (*log)->skipped();
  }
  return read;
}

/// Adds all logs to the map, along the trajectory.
/// @param calibration  of the sonar's place on the vehicle, which the trajectory goes with; nullptr: it is as mounted
Result<MappedBeams> map_along(const Trajectory& trajectory, const SlamCalibration* calibration,
                              const SlamCommand& command, const SlamOptions& slam, OccupancyMap& map,
                              Console& console) {
  VehiclePath path{trajectory, std::nullopt};
  path.advice = VehiclePath::kNavMustCover;
  if (calibration != nullptr) {
    path.sonar_moved_m = {calibration->sonar_x_m.value, calibration->sonar_y_m.value, 0.0};
  }
  BuildOptions build = BuildArgs().build;
  build.filter = slam.filter;
  build.echo = slam.echo;
  build.sound_speed_ratio = slam.sound_speed_ratio;
  build.body_from_sensor = slam.body_from_sonar;
  MappedBeams all;
  for (const std::string& name : command.logs) {
    auto beams = open_beam_log(name, command);
    if (!beams) return tl::unexpected(beams.error());
    const Result<MappedLog> mapped = map_log(Log(std::move(*beams)), name, path, build, {}, map);
    if (!mapped) return tl::unexpected(mapped.error());
    if (!mapped->skipped_text.empty()) {
      console.say(fmt::format("{}: left out of the map: {}", name, mapped->skipped_text));
    }
    all.beams += mapped->report.beams;
    all.skipped += mapped->report.skipped;
  }
  return all;
}

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

Result<void> write_covariances(const SlamSolution& solution, const std::string& path) {
  return write_file(path, [&](std::ostream& out) -> Result<void> {
    out << "time_s,x_x,x_y,y_y,x_yaw,y_yaw,yaw_yaw\n";
    for (const auto& [time_s, c] : solution.covariances) {
      out << fmt::format("{:.9f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", time_s, c(0, 0), c(0, 1), c(1, 1),
                         c(0, 2), c(1, 2), c(2, 2));
    }
    return {};
  });
}

JsonObject json_of(const Seconds& seconds) {
  JsonObject json;
  return json.add("read", round_to_us(seconds.read))
      .add("solve", round_to_us(seconds.solve))
      .add("map", round_to_us(seconds.map))
      .add("write", round_to_us(seconds.write))
      .add("total", round_to_us(seconds.total));
}

std::string json_of(const SlamSolution& solution, const SlamCommand& command, const Inputs& inputs,
                    const SlamOptions& slam, const Seconds& seconds) {
  const SlamReport& report = solution.report;
  JsonObject loops, submap_loops, velocity, largest, json;
  loops.add("found", report.loops_found).add("kept", report.loops_kept);
  submap_loops.add("found", report.submap_loops_found).add("kept", report.submap_loops_kept);
  largest.add("knots", report.largest.knots).add("echoes", report.largest.echoes).add("pairs", report.largest.pairs);
  velocity.add("source", report.velocity)
      .add("samples", report.velocities)
      .add("clipped", report.velocities_clipped)
      .add("longest_gap_s", report.longest_gap_s);
  if (report.by_sonar) {
    JsonObject by_sonar;
    by_sonar.add("matched", report.by_sonar->matched)
        .add("noise_m_sqrt_s", report.by_sonar->noise_m_sqrt_s)
        .add("drift_m", report.by_sonar->drift_m);
    velocity.add("by_sonar", by_sonar);
  } else {
    velocity.add_null("by_sonar");
  }
  if (report.velocity_check) {
    JsonObject check;
    check.add("sweeps", report.velocity_check->sweeps).add("difference_m_s", report.velocity_check->difference_m_s);
    velocity.add("check", check);
  } else {
    velocity.add_null("check");
  }
  json.add("poses", solution.trajectory.poses().size())
      .add("beams", report.beams)
      .add("sweeps", report.sweeps)
      .add("echoes", report.echoes)
      .add("skipped", inputs.skipped)
      .add("sound_speed_m_s", slam.sound_speed_ratio * kAssumedSoundSpeed_m_s)
      .add("knots", report.knots)
      .add("pairs", report.pairs)
      .add("pair_median_m", report.pair_median_m)
      .add("loops", loops)
      .add("submap_loops", submap_loops)
      .add("velocity", velocity)
      .add("heading", report.heading)
      .add("nav_clock", json_of(inputs.nav_offset));
  command.slam.estimation == Estimation::kCausal ? json.add("largest", largest) : json.add_null("largest");
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
    json.add("map", mapped.add("beams", inputs.mapped->beams).add("skipped", inputs.mapped->skipped));
  } else {
    json.add_null("map");
  }
  json.add("recorded_s", recorded_s(solution)).add("seconds", json_of(seconds));
  json.add("real_time_factor", recorded_s(solution) / seconds.total);
  return json.text() + "\n";
}

std::string degrees_text(const Estimate& estimate) {
  return fmt::format("{:.2f} +- {:.2f}", to_degrees(estimate.value), to_degrees(estimate.deviation));
}

std::string title_of(const SlamCommand& command) {
  return command.output == "-" ? "standard output\n" : on_one_line(command.output) + "\n";
}

std::string seconds_text(const Seconds& seconds) {
  return fmt::format("{:.3f} = {:.3f} read + {:.3f} solve + {:.3f} map + {:.3f} write + rest", seconds.total,
                     seconds.read, seconds.solve, seconds.map, seconds.write);
}

std::string velocity_text(const SlamReport& report) {
  if (const auto& sonar = report.by_sonar) {
    return fmt::format(
        "not measured, but by the sonar: {} of {} sweeps match those before them, longest gap {:.0f} s; "
        "without pairs it drifts by {:.1f} m",
        sonar->matched, report.sweeps, report.longest_gap_s, sonar->drift_m);
  }
  const std::string check =
      report.velocity_check ? fmt::format("{:.2f} m/s from what the sonar sees", report.velocity_check->difference_m_s)
                            : std::string("not checked by the sonar");
  return fmt::format("{}, {} samples, {} clipped, longest gap {:.2f} s; {}", on_one_line(report.velocity),
                     report.velocities, report.velocities_clipped, report.longest_gap_s, check);
}

std::string sensors_text(const SlamSolution& solution) {
  const SlamCalibration& c = solution.calibration;
  std::string text;
  if (!solution.report.by_sonar) {
    text = fmt::format("velocity turned by {} degrees, scaled by {:.4f} +- {:.4f}; ", degrees_text(c.velocity_yaw_rad),
                       1.0 + c.velocity_scale.value, c.velocity_scale.deviation);
  }
  return text + fmt::format("sonar moved by {:.2f} {:.2f} m; wall at {:.2f} in its echo", c.sonar_x_m.value,
                            c.sonar_y_m.value, c.wall_in_echo.value);
}

std::string text_of(const SlamSolution& solution, const SlamCommand& command, const Inputs& inputs,
                    const Seconds& seconds) {
  const SlamReport& report = solution.report;
  std::string text = title_of(command);
  text += report_line(
      "read", fmt::format("{} beams, {} complete sweeps, {} echoes", report.beams, report.sweeps, report.echoes));
  text += report_line("nav clock", text_of(inputs.nav_offset));
  if (inputs.nav_water) text += report_line("water", water_text(*inputs.nav_water));
  text += report_line("velocity", velocity_text(report));
  text += report_line("trajectory",
                      fmt::format("{} poses over {:.1f} s", solution.trajectory.poses().size(), recorded_s(solution)));
  if (command.slam.matching == Matching::kPairs) {
    text += report_line("pairs", report.pairs == 0
                                     ? "none: nothing but velocity and headings tells the poses"
                                     : fmt::format("{}, median distance {:.2f} m, {} of {} loops kept", report.pairs,
                                                   report.pair_median_m, report.loops_kept, report.loops_found));
    if (report.submap_loops_found > 0) {
      text += report_line(
          "submaps", fmt::format("{} of {} loops kept before", report.submap_loops_kept, report.submap_loops_found));
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
    text +=
        report_line("not known",
                    on_one_line(fmt::format("{}: the recording hardly tells", fmt::join(report.not_observable, ", "))));
  }
  if (!report.implausible.empty()) {
    text +=
        report_line("implausible", on_one_line(fmt::format("{}: far from what was expected; are --mount, --nav-mount "
                                                           "and --nav-offset right?",
                                                           fmt::join(report.implausible, ", "))));
  }
  return text + report_line("seconds", fmt::format("{}; {:.0f} times real time", seconds_text(seconds),
                                                   recorded_s(solution) / seconds.total));
}

Result<void> write_results(const Trajectory& trajectory, const OccupancyMap& map, const SlamCommand& command) {
  auto written = write_file(command.output, [&](std::ostream& out) { return write_tum(trajectory, out); });
  if (!written || !command.map) return written;
  return write_map(map, command.map_format, command.made_by, *command.map);
}

/// What is known of the sensors; mounts of the command line win.
Result<void> use_calibration(const std::string& path, const NavLog& log, SlamOptions& options) {
  Result<CalibrationFile> file = read_calibration(path);
  if (!file) return tl::unexpected(file.error());
  for (const auto& [source, pose] : file->body_from_source) {
    if (std::ranges::find(log.sources(), source, &NavSource::name) != log.sources().end()) {
      options.body_from_source.emplace(source, pose);
    }
  }
  options.calibration = std::move(file->calibration);
  return {};
}

Result<int> run_beams(const SlamCommand& command, std::unique_ptr<BeamSource> first, Console& console) {
  const Stopwatch total;
  Seconds seconds;
  Result<OccupancyMap> map = OccupancyMap::make({.resolution_m = command.map_resolution_m});
  if (!map) return tl::unexpected(map.error());
  const Stopwatch read;
  const Result<NavFiles> nav = read_navs(command.navs, command.damage, command.bag.nav);
  if (!nav) return tl::unexpected(nav.error());
  Result<NavOffset> offset =
      nav_offset(command.nav_offset_s, nav->log, {command.logs.front(), command.bag.beams}, command.damage);
  if (!offset) return tl::unexpected(offset.error());
  Inputs inputs;
  inputs.nav_offset = *std::move(offset);
  SlamOptions options = command.slam;
  options.nav_offset_s = inputs.nav_offset.offset_s;
  if (command.nav_salinity) {
    const Result<Water> water = water_of(water_around(nav->log), *command.nav_salinity);
    if (!water) return tl::unexpected(water.error());
    inputs.nav_water = *water;
    options.sound_speed_ratio = sound_speed_ratio(*water);
  }
  if (command.known_calibration) {
    if (const auto known = use_calibration(*command.known_calibration, nav->log, options); !known) {
      return tl::unexpected(known.error());
    }
  }
  SlamSmoother smoother(options);
  const Result<Read> all = read_all(smoother, *nav, command, std::move(first));
  if (!all) return tl::unexpected(all.error());
  inputs.skipped = all->skipped;
  seconds.read = read.seconds();

  ProgressBar bar(command.output_options);
  bar.draw(std::nullopt, "solving");
  const Stopwatch solve;
  const Result<SlamSolution> solution = smoother.solve();
  if (!solution) {
    const bool lacks_nav = command.navs.empty() && all->beams > 0 && solution.error().code == Error::Code::kUnsupported;
    return fail(solution.error().code,
                fmt::format("{}: {}{}", inputs_text(command), solution.error().message,
                            lacks_nav ? ": give the navigation with --nav, a heading or a turn rate at least" : ""));
  }
  seconds.solve = solve.seconds();

  if (command.map) {
    bar.draw(std::nullopt, "mapping");
    const Stopwatch mapping;
    const std::optional<SlamCalibration>& known = options.calibration;
    const SlamCalibration* calibration =
        options.matching == Matching::kPairs ? &solution->calibration : (known ? &*known : nullptr);
    const Result<MappedBeams> mapped = map_along(solution->trajectory, calibration, command, options, *map, console);
    if (!mapped) return tl::unexpected(mapped.error());
    inputs.mapped = *mapped;
    seconds.map = mapping.seconds();
  }
  bar.clear();

  const Stopwatch write;
  const auto written = write_results(solution->trajectory, *map, command);
  if (!written) return tl::unexpected(written.error());
  if (command.calibration) {
    const auto calibrated = write_file(*command.calibration, [&](std::ostream& out) -> Result<void> {
      out << calibration_toml({solution->calibration, options.body_from_source});
      return {};
    });
    if (!calibrated) return tl::unexpected(calibrated.error());
  }
  if (command.covariance) {
    if (const auto done = write_covariances(*solution, *command.covariance); !done) return tl::unexpected(done.error());
  }
  seconds.write = write.seconds();
  seconds.total = total.seconds();
  const Result<void> summary = command.output_options.report == Report::kJson
                                   ? console.print(json_of(*solution, command, inputs, options, seconds))
                                   : console.summarise(text_of(*solution, command, inputs, seconds), command.output);
  if (!summary) return tl::unexpected(summary.error());
  return 0;
}

/// Scans of a log moved to the poses of a trajectory over their numbers.
class MovedScans : public ScanSource {
 public:
  MovedScans(std::unique_ptr<ScanSource> scans, const Trajectory& trajectory)
      : scans_(std::move(scans)), trajectory_(trajectory) {}

  Result<std::optional<PointScan>> next() override {
    Result<std::optional<PointScan>> scan = scans_->next();
    if (!scan || !*scan) return scan;
    const std::optional<Pose> pose = trajectory_.at(static_cast<double>((*scan)->number));
    assert(pose);
    const Pose moved = *pose * Pose(Eigen::Translation3d((*scan)->origin_m) * (*scan)->rotation).inverse();
    (*scan)->origin_m = pose->translation();
    for (Eigen::Vector3d& point : (*scan)->points_m) point = moved * point;
    return scan;
  }

 private:
  std::unique_ptr<ScanSource> scans_;
  const Trajectory& trajectory_;
};

Result<void> map_scans(const Trajectory& trajectory, const SlamCommand& command, OccupancyMap& map) {
  Result<Log> log = open(command.logs.front(), command);
  if (!log) return tl::unexpected(log.error());
  auto* scans = std::get_if<std::unique_ptr<ScanSource>>(&*log);
  if (scans == nullptr) return fail(Error::Code::kIo, fmt::format("{}: has changed", command.logs.front()));
  MovedScans moved(std::move(*scans), trajectory);
  const auto report = build_map(moved, BuildOptions{}, map);
  return report ? Result<void>() : tl::unexpected(report.error());
}

std::string json_of(const ScanSlamReport& report, std::size_t skipped, const Seconds& seconds) {
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

std::string text_of(const ScanSlamReport& report, const SlamCommand& command, const Seconds& seconds) {
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

Result<int> run_scans(const SlamCommand& command, std::unique_ptr<ScanSource> scans, Console& console) {
  if (command.logs.size() > 1) {
    return fail(Error::Code::kBadOption,
                fmt::format("slam: unexpected argument '{}': scans of points are of one log", command.logs[1]));
  }
  const Stopwatch total;
  Seconds seconds;
  Result<OccupancyMap> map = OccupancyMap::make({.resolution_m = command.map_resolution_m});
  if (!map) return tl::unexpected(map.error());
  const Stopwatch read;
  ScanSlam slam;
  for (;;) {
    const Result<std::optional<PointScan>> scan = scans->next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan) break;
    slam.add(**scan);
  }
  seconds.read = read.seconds();

  ProgressBar bar(command.output_options);
  bar.draw(std::nullopt, "solving");
  const Stopwatch solve;
  const Result<ScanSlamSolution> solution = slam.solve();
  if (!solution) {
    return fail(solution.error().code, fmt::format("{}: {}", command.logs.front(), solution.error().message));
  }
  seconds.solve = solve.seconds();
  if (command.map) {
    bar.draw(std::nullopt, "mapping");
    const Stopwatch mapping;
    const Result<void> mapped = map_scans(solution->trajectory, command, *map);
    if (!mapped) return tl::unexpected(mapped.error());
    seconds.map = mapping.seconds();
  }
  bar.clear();
  const Stopwatch write;
  const auto written = write_results(solution->trajectory, *map, command);
  if (!written) return tl::unexpected(written.error());
  if (command.graph) {
    const auto drawn = write_file(*command.graph, [&](std::ostream& out) { return write_g2o(solution->graph, out); });
    if (!drawn) return tl::unexpected(drawn.error());
  }
  seconds.write = write.seconds();
  seconds.total = total.seconds();
  const Result<void> summary = command.output_options.report == Report::kJson
                                   ? console.print(json_of(solution->report, scans->skipped(), seconds))
                                   : console.summarise(text_of(solution->report, command, seconds), command.output);
  if (!summary) return tl::unexpected(summary.error());
  return 0;
}

}  // namespace

Result<int> run(const SlamCommand& command, Console& console) {
  Result<Log> first = open(command.logs.front(), command);
  if (!first) return tl::unexpected(first.error());
  const bool is_beams = std::holds_alternative<std::unique_ptr<BeamSource>>(*first);
  if (const auto used = check_limited(command.limited, {kind_text(is_beams ? FormatKind::kBeams : FormatKind::kScans)});
      !used) {
    return fail(used.error().code, fmt::format("slam: {}", used.error().message));
  }
  return is_beams ? run_beams(command, std::get<std::unique_ptr<BeamSource>>(std::move(*first)), console)
                  : run_scans(command, std::get<std::unique_ptr<ScanSource>>(std::move(*first)), console);
}

}  // namespace pingvox::app
