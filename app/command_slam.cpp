#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "evaluation_text.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "open_recording.hpp"
#include "pingvox/io/file.hpp"
#include "progress.hpp"
#include "recording_report.hpp"
#include "recording_warnings.hpp"
#include "slam_files.hpp"
#include "slam_report.hpp"
#include "slam_scans.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// The files that a solution is made of: "dive.csv, nav.csv"
std::string inputs_text(const SlamCommand& command) {
  std::string text = name_of_input(command.recording.logs.front());
  for (const std::string& nav : command.recording.path.navs) {
    if (nav != command.recording.logs.front()) text += ", " + nav;
  }
  return text;
}

/// Adds all logs to the map, along the path.
Result<MappedBeams> map_along(const Recording& recording, const RecordingSlam& slam, BuildOptions build,
                              OccupancyMap& map, Console& console) {
  const VehiclePath path = slam.path();
  build.filter = slam.options.filter;
  build.echo = slam.options.echo;
  build.sound_speed_ratio = slam.options.sound_speed_ratio;
  MappedBeams all;
  std::vector<std::string> nothing;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    Result<OpenedLog> log = open_log_of(recording, i);
    if (!log) return tl::unexpected(log.error());
    const Result<MappedLog> mapped = map_log(recording, *log, path, build, map);
    if (!mapped) return tl::unexpected(mapped.error());
    const std::string skipped = skipped_text(*mapped, path.trajectory, kNavMustCover, map.lattice());
    if (mapped->is_nothing()) {
      nothing.push_back(text_of_nothing(log->name, skipped));
    } else if (!skipped.empty()) {
      console.say(fmt::format("{}: not mapped: {}", log->name, skipped));
    }
    for (const std::string& warning : coverage_warnings(mapped->report.coverage)) {
      console.say(fmt::format("{}: {}", log->name, warning));
    }
    all.beams += mapped->report.beams;
    all.skipped += mapped->report.skipped;
  }
  return say_nothing_mapped(nothing, recording.logs().size(), console).map([&] { return all; });
}

std::vector<std::string> used_sources(const SlamSolution& solution) {
  std::vector<std::string> used = {solution.report.velocity.source, solution.report.heading};
  for (const HeadingCalibration& heading : solution.calibration.headings) used.push_back(heading.source);
  return used;
}

/// What SLAM was not told of the vehicle, and takes to be.
std::vector<std::string> taken_for_granted(const SlamCommand& command, const Recording& recording) {
  std::vector<std::string> texts;
  if (!command.recording.has_mount && mount_hint(recording).empty()) {
    texts.emplace_back("without --mount the head is assumed at the origin of the vehicle, upright, looking ahead");
  }
  if (!command.recording.path.navs.empty() && recording.nav().log.best(NavQuantity::kAttitude) == nullptr) {
    texts.push_back(fmt::format("{}: no attitude: the vehicle is assumed level", recording.nav_names()));
  }
  return texts;
}

/// Refuses options of beams where the format of the log says that it holds scans, before other files are read.
Result<void> check_options_of_scans(const SlamCommand& command) {
  const std::string& first = command.recording.logs.front();
  if (first == "-") return {};
  const Result<Format> format =
      ByteStream::open(first).and_then([](ByteStream stream) { return identify_format(stream); });
  if (!format || kind_of(*format) != FormatKind::kScans) return {};
  return check_limited(command.limited, {kind_text(FormatKind::kScans)}).map_error([](const Error& error) {
    return Error{error.code, fmt::format("slam: {}", error.message)};
  });
}

/// What to do where SLAM failed.
Error advise_on_slam(Error error, const SlamCommand& command) {
  // Navigation does not help where there are no beams.
  const bool has_beams = !error.message.ends_with("there are no beams");
  if (!command.recording.path.navs.empty() || error.code != Error::Code::kUnsupported || !has_beams) return error;
  const std::string in_bag = hint_at_nav(command.recording.logs.front());
  error.message +=
      in_bag.empty() ? ": give the navigation with --nav, a heading or a turn rate at least" : ": " + in_bag;
  return error;
}

Result<int> run_beams(const SlamCommand& command, const Recording& recording, OpenedLog first, Console& console) {
  const Stopwatch total;
  SlamSeconds seconds;
  if (const std::string hint = mount_hint(recording); !hint.empty()) console.say(hint);
  ProgressBar bar(command.output_options);
  bar.draw(std::nullopt, "solving");
  const Result<RecordingSlam> found = slam(recording, command.slam, command.estimation, std::move(first));
  bar.clear();
  if (!found) return tl::unexpected(advise_on_slam(found.error(), command));
  const SlamSolution& solution = found->solution;
  for (const std::string& taken : taken_for_granted(command, recording)) console.say(taken);
  for (const std::string& warning : nav_warnings(recording)) console.say(warning);
  for (const auto& [file, note] : found->notes) console.say(fmt::format("{}: {}", file, note));
  // A few before and after the navigation are usual.
  if (2 * found->no_pose.count > found->beams) {
    const auto& poses = solution.trajectory.poses();
    console.say(
        fmt::format("{}: {} of {} beams are outside the time of the navigation, {:.3f} s to {:.3f} s, the first "
                    "at {:.3f} s ({})",
                    inputs_text(command), found->no_pose.count, found->beams, poses.front().time_s, poses.back().time_s,
                    found->no_pose.first_s.value_or(0.0), kNavMustCover));
  }
  seconds.read = found->read_s;
  seconds.solve = found->solve_s;
  SlamInputs inputs{.others = other_sources(recording.nav().log, kMotionQuantities, used_sources(solution))};

  Result<OccupancyMap> map = OccupancyMap::make(command.map_options);
  if (!map) return tl::unexpected(map.error());
  if (command.map) {
    const Stopwatch mapping;
    const Result<MapForecast> forecast = forecast_map(recording, command.map_options, command.build);
    if (!forecast) return tl::unexpected(forecast.error());
    if (const std::string cost = cost_text(*forecast); !cost.empty()) console.say(*command.map + ": " + cost);
    map = make_map(*forecast, command.map_options);
    if (!map) return tl::unexpected(map.error());
    bar.draw(std::nullopt, "mapping");
    const Result<MappedBeams> mapped = map_along(recording, *found, command.build, *map, console);
    if (!mapped) return tl::unexpected(mapped.error());
    inputs.mapped = *mapped;
    inputs.mapped->resolution = resolution_text(*forecast, command.map_options);
    inputs.mapped->resolution_m = forecast->resolution_m;
    seconds.map = mapping.seconds();
  }
  bar.clear();

  const Stopwatch write;
  const auto written = write_slam_results(solution.trajectory, *map, MapAxes::kEastNorth, command);
  if (!written) return tl::unexpected(written.error());
  if (command.calibration) {
    const auto calibrated = write_file(*command.calibration, [&](std::ostream& out) -> Result<void> {
      out << kCalibrationComment << calibration_toml({solution.calibration, found->options.body_from_source});
      return {};
    });
    if (!calibrated) return tl::unexpected(calibrated.error());
  }
  if (command.covariance) {
    if (const auto done = write_covariances(solution, *command.covariance); !done) return tl::unexpected(done.error());
  }
  seconds.write = write.seconds();
  seconds.total = total.seconds();
  if (const auto& implausible = solution.report.implausible; !implausible.empty()) {
    console.say(
        fmt::format("{}: implausible: {}: far from what was expected; are --mount, --nav-mount and --nav-offset "
                    "right?",
                    inputs_text(command), fmt::join(implausible, ", ")));
  }
  const Result<void> summary =
      command.output_options.report == Report::kJson
          ? console.print(slam_json(recording, *found, command, inputs, seconds))
          : console.summarise(slam_text(recording, *found, command, inputs, seconds), command.output);
  if (!summary) return tl::unexpected(summary.error());
  return 0;
}

}  // namespace

Result<int> run(const SlamCommand& typed, Console& console) {
  SlamCommand command = typed;
  if (const auto found = expand_folders(command.recording.logs, console); !found) return tl::unexpected(found.error());
  if (const auto used = check_options_of_scans(command); !used) return tl::unexpected(used.error());
  const Result<Recording> recording = open_recording(command.recording);
  if (!recording) return tl::unexpected(recording.error());
  Result<OpenedLog> first = open_log_of(*recording, 0);
  if (!first) return tl::unexpected(first.error());
  const bool is_beams = first->beams() != nullptr;
  if (const auto used = check_limited(command.limited, {kind_text(is_beams ? FormatKind::kBeams : FormatKind::kScans)});
      !used) {
    return fail(used.error().code, fmt::format("slam: {}", used.error().message));
  }
  return is_beams ? run_beams(command, *recording, *std::move(first), console)
                  : run_scans(command, std::get<std::unique_ptr<ScanSource>>(std::move(first->log)), console);
}

}  // namespace pingvox::app
