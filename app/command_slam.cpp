#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "calibration_file.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "map_log.hpp"
#include "mapping_options.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "pingvox/io/beams_in_order.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "progress.hpp"
#include "slam_files.hpp"
#include "slam_report.hpp"
#include "slam_scans.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// The files that a solution is made of: "dive.csv, nav.csv"
std::string inputs_text(const SlamCommand& command) {
  std::string text = name_of_input(command.logs.front());
  for (const std::string& nav : command.navs) {
    if (nav != command.logs.front()) text += ", " + nav;
  }
  return text;
}

struct Read {
  std::size_t beams = 0, skipped = 0;
  std::vector<std::string> notes = {};  ///< of the logs
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
    auto log = first ? std::exchange(first, nullptr) : open_slam_beams(name, command);
    if (!log) return tl::unexpected(log.error());
    if (!command.navs.empty()) {
      if (const auto has = check_has_times(**log, name); !has) return tl::unexpected(has.error());
    }
    const std::unique_ptr<BeamSource> beams = in_order(*std::move(log), name);
    for (;;) {
      Result<std::optional<Beam>> beam = beams->next();
      if (!beam) return tl::unexpected(beam.error());
      if (!*beam) break;
      smoother.add(std::move(**beam));
      ++read.beams;
    }
    read.skipped += beams->skipped();
    if (const std::string note = beams->note(); !note.empty()) read.notes.push_back(fmt::format("{}: {}", name, note));
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
  BuildOptions build;
  build.filter = slam.filter;
  build.echo = slam.echo;
  build.sound_speed_ratio = slam.sound_speed_ratio;
  build.body_from_sensor = slam.body_from_sonar;
  MappedBeams all;
  std::vector<std::string> nothing;
  for (const std::string& name : command.logs) {
    auto beams = open_slam_beams(name, command);
    if (!beams) return tl::unexpected(beams.error());
    const Result<MappedLog> mapped = map_log(Log(std::move(*beams)), name, path, build, {}, map);
    if (!mapped) return tl::unexpected(mapped.error());
    if (mapped->is_nothing) {
      nothing.push_back(text_of_nothing(*mapped, name));
    } else if (!mapped->skipped_text.empty()) {
      console.say(fmt::format("{}: left out of the map: {}", name, mapped->skipped_text));
    }
    all.beams += mapped->report.beams;
    all.skipped += mapped->report.skipped;
  }
  return say_nothing_mapped(nothing, command.logs.size(), console).map([&] { return all; });
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

std::vector<std::string> used_sources(const SlamSolution& solution) {
  std::vector<std::string> used = {solution.report.velocity, solution.report.heading};
  for (const HeadingCalibration& heading : solution.calibration.headings) used.push_back(heading.source);
  return used;
}

Result<int> run_beams(const SlamCommand& command, std::unique_ptr<BeamSource> first, Console& console) {
  const Stopwatch total;
  SlamSeconds seconds;
  Result<OccupancyMap> map = OccupancyMap::make({.resolution_m = command.map_resolution_m});
  if (!map) return tl::unexpected(map.error());
  const Stopwatch read;
  const Result<NavFiles> nav =
      read_navs(command.navs, command.damage, command.bag.nav, {.log = {}, .topic = {}, .chosen = command.nav_sources});
  if (!nav) return tl::unexpected(nav.error());
  Result<NavOffset> offset =
      nav_offset(command.nav_offset_s, *nav, {command.logs.front(), command.bag.beams, command.slam.body_from_sonar},
                 command.damage);
  if (!offset) return tl::unexpected(offset.error());
  if (command.slam.body_from_sonar.matrix().isIdentity(0.0)) {
    const std::string hint = mount_hint(nav->bags, command.logs.front(), command.bag.beams.name);
    if (!hint.empty()) console.say(hint);
  }
  SlamInputs inputs;
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
  for (const std::string& warning : nav->warnings) console.say(warning);
  inputs.skipped = all->skipped;
  for (const std::string& note : all->notes) console.say(note);
  seconds.read = read.seconds();

  ProgressBar bar(command.output_options);
  bar.draw(std::nullopt, "solving");
  const Stopwatch solve;
  const Result<SlamSolution> solution = smoother.solve();
  if (!solution) {
    std::string advice;
    if (command.navs.empty() && all->beams > 0 && solution.error().code == Error::Code::kUnsupported) {
      const std::string in_bag = hint_at_nav(command.logs.front());
      advice = in_bag.empty() ? ": give the navigation with --nav, a heading or a turn rate at least" : ": " + in_bag;
    }
    return fail(solution.error().code, fmt::format("{}: {}{}", inputs_text(command), solution.error().message, advice));
  }
  seconds.solve = solve.seconds();
  inputs.nav_others = NavOthers(nav->log, kMotionQuantities, used_sources(*solution));

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
  const auto written = write_slam_results(solution->trajectory, *map, command);
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
  if (const auto& implausible = solution->report.implausible; !implausible.empty()) {
    console.say(
        fmt::format("{}: implausible: {}: far from what was expected; are --mount, --nav-mount and --nav-offset "
                    "right?",
                    inputs_text(command), fmt::join(implausible, ", ")));
  }
  const Result<void> summary = command.output_options.report == Report::kJson
                                   ? console.print(slam_json(*solution, command, inputs, options, seconds))
                                   : console.summarise(slam_text(*solution, command, inputs, seconds), command.output);
  if (!summary) return tl::unexpected(summary.error());
  return 0;
}

}  // namespace

Result<int> run(const SlamCommand& command, Console& console) {
  Result<Log> first = open_slam_log(command.logs.front(), command);
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
