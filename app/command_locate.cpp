#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "locate_report.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "open_recording.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/recording/recording.hpp"
#include "progress.hpp"
#include "recording_report.hpp"
#include "recording_warnings.hpp"
#include "step_report.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// kBadOption when --start is outside of the map.
Result<void> check_start(const LocateCommand& command, const OccupancyMap& map) {
  const std::optional<Box> bounds = map.bounds();
  if (!command.start || !bounds) return {};
  const Eigen::Array2d at(command.start->x_m, command.start->y_m);
  const double margin_m = 3.0 * command.start->deviation_m;
  if ((at >= bounds->min.head<2>().array() - margin_m).all() &&
      (at <= bounds->max.head<2>().array() + margin_m).all()) {
    return {};
  }
  return fail(Error::Code::kBadOption, fmt::format("--start: {:.6g}, {:.6g} is outside of {}, which has {}", at.x(),
                                                   at.y(), command.map, bounds_text(bounds)));
}

Result<OccupancyMap> map_in(const std::string& name) {
  return read_file(name).and_then([](const FileBytes& file) { return read_map(file); }).map([](MapFile map) {
    return std::move(map.map);
  });
}

/// nullopt: none is sure.
Result<std::optional<Trajectory>> found_trajectory(const LocatedRecording& found, const LocateCommand& command,
                                                   Console& console) {
  if (command.written == WrittenPoses::kSure) return found.known_trajectory();
  if (const std::size_t unsure = unsure_poses(found); unsure > 0) {
    console.say(
        fmt::format("{}: {} of {} poses may be wrong, while several places fit, or none does: --only-sure leaves them "
                    "out",
                    command.recording.logs.front(), unsure, found.poses.size()));
  }
  return found.trajectory().map([](Trajectory all) { return std::optional(std::move(all)); });
}

}  // namespace

Result<int> run(const LocateCommand& command, Console& console) {
  const Stopwatch total;
  LocateSeconds seconds;
  const Result<OccupancyMap> map = map_in(command.map);
  if (!map) return tl::unexpected(map.error());
  if (const auto inside = check_start(command, *map); !inside) return tl::unexpected(inside.error());
  const Result<Recording> recording = open_recording(command.recording);
  if (!recording) return tl::unexpected(recording.error());
  for (const std::string& warning : nav_warnings(*recording)) console.say(warning);
  if (const std::string hint = mount_hint(*recording); !hint.empty()) console.say(hint);
  seconds.read = total.seconds();

  ProgressBar bar(command.output_options);
  const RecordingLocateOptions options{
      {command.localizer, command.start, command.estimation}, command.min_z_m, command.max_z_m, command.map};
  const Result<RecordingLocation> location = locate(*recording, *map, options, [&](double share) {
    if (bar.is_due()) bar.draw(share, "locating");
  });
  bar.clear();
  if (!location) return tl::unexpected(location.error());
  seconds.read += location->read_s;
  const LocatedRecording& found = location->found;
  for (const std::string& step : step_texts(location->steps, location->odometry_poses)) {
    console.say(fmt::format("{}: {}", *command.recording.path.poses, step));
  }
  if (found.clock_check && found.clock_check->is_apart()) {
    const std::string advice = command.recording.path.poses
                                   ? "is the clock of --odometry right?"
                                   : nav_offset_advice(*recording->nav_offset(), *found.clock_check);
    console.say(fmt::format("{}: {}", name_of_input(command.recording.logs.front()),
                            wrong_clock_text(*found.clock_check, advice)));
  }
  const Result<std::optional<Trajectory>> trajectory = found_trajectory(found, command, console);
  if (!trajectory) return tl::unexpected(trajectory.error());
  std::size_t written = 0;
  if (*trajectory) {
    written = (*trajectory)->poses().size();
    const auto done = write_file(command.output, [&](std::ostream& out) { return write_tum(**trajectory, out); });
    if (!done) return tl::unexpected(done.error());
  }
  seconds.total = total.seconds();
  const Result<void> summary =
      command.output_options.report == Report::kJson
          ? console.print(locate_json(*recording, *location, written, seconds))
          : console.summarise(locate_text(*recording, *location, command, written, seconds), command.output);
  if (!summary) return tl::unexpected(summary.error());
  if (!*trajectory) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: no pose of the vehicle is certain", name_of_input(command.recording.logs.front())));
  }
  return 0;
}

}  // namespace pingvox::app
