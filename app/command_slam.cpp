#include <fmt/core.h>

#include <cmath>
#include <memory>
#include <optional>
#include <ostream>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "json.hpp"
#include "map_log.hpp"
#include "map_report.hpp"
#include "mapping_options.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "option_values.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/tum.hpp"
#include "progress.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

struct Seconds {
  double read = 0.0, solve = 0.0, map = 0.0, write = 0.0, total = 0.0;
};

/// Opens a log of beams.
Result<std::unique_ptr<BeamSource>> open_beam_log(const std::string& file, Damage damage) {
  Result<ByteStream> stream = ByteStream::open(file);
  if (!stream) return tl::unexpected(stream.error());
  const std::string name = stream->name();
  Result<Log> log = open_log(std::move(*stream), damage);
  if (!log) return tl::unexpected(log.error());
  if (auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&*log)) return std::move(*beams);
  return fail(Error::Code::kUnsupported, fmt::format("{}: holds scans of points, not beams of a sonar", name));
}

/// Gives the smoother all beams and navigation. Returns how many records were skipped.
Result<std::size_t> read_all_into(SlamSmoother& smoother, const SlamCommand& command) {
  std::size_t skipped = 0;
  for (const std::string& name : command.navs) {
    const Result<FileBytes> file = read_file(name);
    if (!file) return tl::unexpected(file.error());
    const Result<NavFile> nav = read_nav(*file, command.damage);
    if (!nav) return tl::unexpected(nav.error());
    if (const auto added = smoother.add(nav->log); !added) {
      return fail(added.error().code, fmt::format("{}: {}", file->name, added.error().message));
    }
    skipped += damaged_records(*nav);
  }
  for (const std::string& name : command.logs) {
    const auto log = open_beam_log(name, command.damage);
    if (!log) return tl::unexpected(log.error());
    for (;;) {
      Result<std::optional<Beam>> beam = (*log)->next();
      if (!beam) return tl::unexpected(beam.error());
      if (!*beam) break;
      smoother.add(std::move(**beam));
    }
    skipped += (*log)->skipped();
  }
  return skipped;
}

/// Adds all logs to the map, along the trajectory.
Result<void> map_along(const Trajectory& trajectory, const SlamCommand& command, OccupancyMap& map, Console& console) {
  const VehiclePath path{trajectory, std::nullopt};
  BuildOptions build = BuildArgs().build;
  build.filter = command.slam.filter;
  build.echo = command.slam.echo;
  build.sound_speed_ratio = command.slam.sound_speed_ratio;
  build.body_from_sensor = command.slam.body_from_sonar;
  for (const std::string& name : command.logs) {
    auto beams = open_beam_log(name, command.damage);
    if (!beams) return tl::unexpected(beams.error());
    const Result<MappedLog> mapped = map_log(Log(std::move(*beams)), name, path, build, {}, map);
    if (!mapped) return tl::unexpected(mapped.error());
    if (!mapped->skipped_text.empty()) console.say(fmt::format("{}: skipped {}", name, mapped->skipped_text));
  }
  return {};
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

std::string toml_line(std::string_view name, const Estimate& estimate, double unit = 1.0) {
  return fmt::format("{} = {:.6g}\n{}-sd = {:.2g}\n", name, estimate.value / unit, name, estimate.deviation / unit);
}

/// A basic string of TOML.
std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : on_one_line(text)) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

std::string calibration_toml(const SlamCalibration& calibration) {
  std::string toml = "# Estimated by pingvox slam; -sd is the standard deviation of the line above.\n" +
                     toml_line("velocity-yaw-deg", calibration.velocity_yaw_rad, kDegree_rad) +
                     toml_line("velocity-scale", calibration.velocity_scale) +
                     toml_line("wall-in-echo", calibration.wall_in_echo) + toml_line("sonar-x", calibration.sonar_x_m) +
                     toml_line("sonar-y", calibration.sonar_y_m);
  for (const HeadingCalibration& heading : calibration.headings) {
    toml += fmt::format("\n[[heading]]\nsource = {}\n", toml_string(heading.source)) +
            toml_line("constant-deg", heading.constant_rad, kDegree_rad) +
            toml_line("sin1-deg", heading.sin1_rad, kDegree_rad) +
            toml_line("cos1-deg", heading.cos1_rad, kDegree_rad) +
            toml_line("sin2-deg", heading.sin2_rad, kDegree_rad) + toml_line("cos2-deg", heading.cos2_rad, kDegree_rad);
  }
  return toml;
}

double recorded_s(const SlamSolution& solution) {
  const auto& poses = solution.trajectory.poses();
  return poses.back().time_s - poses.front().time_s;
}

std::string json_of(const SlamSolution& solution, const SlamCommand& command, std::size_t skipped,
                    const Seconds& seconds) {
  const SlamReport& report = solution.report;
  JsonObject loops, took, velocity, json;
  loops.add("found", report.loops_found).add("kept", report.loops_kept);
  took.add("read", round_to_us(seconds.read))
      .add("solve", round_to_us(seconds.solve))
      .add("map", round_to_us(seconds.map))
      .add("write", round_to_us(seconds.write))
      .add("total", round_to_us(seconds.total));
  velocity.add("source", report.velocity)
      .add("samples", report.velocities)
      .add("clipped", report.velocities_clipped)
      .add("longest_gap_s", report.longest_gap_s);
  json.add("poses", solution.trajectory.poses().size())
      .add("beams", report.beams)
      .add("sweeps", report.sweeps)
      .add("echoes", report.echoes)
      .add("skipped", skipped)
      .add("knots", report.knots)
      .add("pairs", report.pairs)
      .add("pair_median_m", report.pair_median_m)
      .add("loops", loops)
      .add("velocity", velocity)
      .add("heading", report.heading);
  if (command.slam.matching == Matching::kPairs) {
    json.add("calibration", calibration_json(solution.calibration));
  } else {
    json.add_null("calibration");
  }
  json.add("recorded_s", recorded_s(solution)).add("seconds", took);
  json.add("real_time_factor", recorded_s(solution) / seconds.total);
  return json.text() + "\n";
}

std::string degrees_text(const Estimate& estimate) {
  return fmt::format("{:.2f} +- {:.2f}", to_degrees(estimate.value), to_degrees(estimate.deviation));
}

std::string text_of(const SlamSolution& solution, const SlamCommand& command, const Seconds& seconds) {
  const SlamReport& report = solution.report;
  std::string text = command.output == "-" ? "standard output\n" : on_one_line(command.output) + "\n";
  text += report_line(
      "read", fmt::format("{} beams, {} complete sweeps, {} echoes", report.beams, report.sweeps, report.echoes));
  text += report_line("velocity",
                      fmt::format("{}, {} samples, {} clipped, longest gap {:.2f} s", on_one_line(report.velocity),
                                  report.velocities, report.velocities_clipped, report.longest_gap_s));
  text += report_line("trajectory",
                      fmt::format("{} poses over {:.1f} s", solution.trajectory.poses().size(), recorded_s(solution)));
  if (command.slam.matching == Matching::kPairs) {
    const SlamCalibration& c = solution.calibration;
    text += report_line("pairs", fmt::format("{}, median distance {:.2f} m, {} of {} loops kept", report.pairs,
                                             report.pair_median_m, report.loops_kept, report.loops_found));
    text += report_line(
        "sensors", fmt::format("velocity turned by {} degrees, scaled by {:.4f} +- {:.4f}; sonar moved by {:.2f} "
                               "{:.2f} m; wall at {:.2f} in its echo",
                               degrees_text(c.velocity_yaw_rad), 1.0 + c.velocity_scale.value,
                               c.velocity_scale.deviation, c.sonar_x_m.value, c.sonar_y_m.value, c.wall_in_echo.value));
    for (const HeadingCalibration& heading : c.headings) {
      text +=
          report_line("heading", fmt::format("{}: constant {}, deviation {:.2f} and {:.2f} degrees",
                                             on_one_line(heading.source), degrees_text(heading.constant_rad),
                                             to_degrees(std::hypot(heading.sin1_rad.value, heading.cos1_rad.value)),
                                             to_degrees(std::hypot(heading.sin2_rad.value, heading.cos2_rad.value))));
    }
  }
  return text + report_line("seconds", fmt::format("{:.3f} = {:.3f} read + {:.3f} solve + {:.3f} map + {:.3f} write "
                                                   "+ rest; {:.0f} times real time",
                                                   seconds.total, seconds.read, seconds.solve, seconds.map,
                                                   seconds.write, recorded_s(solution) / seconds.total));
}

}  // namespace

Result<int> run(const SlamCommand& command, Console& console) {
  const Stopwatch total;
  Seconds seconds;
  Result<OccupancyMap> map = OccupancyMap::make({.resolution_m = command.map_resolution_m});
  if (!map) return tl::unexpected(map.error());
  SlamSmoother smoother(command.slam);
  const Stopwatch read;
  const Result<std::size_t> skipped = read_all_into(smoother, command);
  if (!skipped) return tl::unexpected(skipped.error());
  seconds.read = read.seconds();

  ProgressBar bar(command.output_options);
  bar.draw(std::nullopt, "solving");
  const Stopwatch solve;
  const Result<SlamSolution> solution = smoother.solve();
  if (!solution)
    return fail(solution.error().code, fmt::format("{}: {}", command.logs.front(), solution.error().message));
  seconds.solve = solve.seconds();

  if (command.map) {
    bar.draw(std::nullopt, "mapping");
    const Stopwatch mapping;
    const Result<void> mapped = map_along(solution->trajectory, command, *map, console);
    if (!mapped) return tl::unexpected(mapped.error());
    seconds.map = mapping.seconds();
  }
  bar.clear();

  const Stopwatch write;
  const auto written =
      write_file(command.output, [&](std::ostream& out) { return write_tum(solution->trajectory, out); });
  if (!written) return tl::unexpected(written.error());
  if (command.map) {
    const auto map_written = write_map(*map, command.map_format, command.made_by, *command.map);
    if (!map_written) return tl::unexpected(map_written.error());
  }
  if (command.calibration) {
    const auto calibrated = write_file(*command.calibration, [&](std::ostream& out) -> Result<void> {
      out << calibration_toml(solution->calibration);
      return {};
    });
    if (!calibrated) return tl::unexpected(calibrated.error());
  }
  seconds.write = write.seconds();
  seconds.total = total.seconds();
  const Result<void> summary = command.output_options.report == Report::kJson
                                   ? console.print(json_of(*solution, command, *skipped, seconds))
                                   : console.summarise(text_of(*solution, command, seconds), command.output);
  if (!summary) return tl::unexpected(summary.error());
  return 0;
}

}  // namespace pingvox::app
