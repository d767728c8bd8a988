#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "locate_files.hpp"
#include "locate_report.hpp"
#include "map_report.hpp"
#include "nav_clock.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/slam/locate_recording.hpp"
#include "progress.hpp"
#include "stopwatch.hpp"

namespace pingvox::app {
namespace {

/// Pose of the odometry at the first beam that has one; nullopt: there is no odometry.
/// @return kUnsupported when none has
Result<std::optional<Pose>> first_pose(const RecordedMotion& motion, const std::vector<Beam>& beams,
                                       const std::string& log) {
  const auto& odometry = motion.odometry_from_body;
  if (!odometry) return std::nullopt;
  for (const Beam& beam : beams) {
    if (auto pose = odometry->at(beam.time_s)) return pose;
  }
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: beams and navigation do not overlap in time: the beams are from {:.3f} to {:.3f} s, "
                          "the navigation is from {:.3f} to {:.3f} s",
                          log, beams.front().time_s, beams.back().time_s, odometry->poses().front().time_s,
                          odometry->poses().back().time_s));
}

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

/// The distance field of the layer of the map around the sonar at the first beam.
Result<DistanceField> field_of(const OccupancyMap& map, const LocateCommand& command, const Pose& first) {
  constexpr double kHalf_m = 0.5;
  const double z_m = (first * command.localizer.body_from_sonar.translation()).z();
  const DistanceFieldOptions layer{command.min_z_m.value_or(z_m - kHalf_m), command.max_z_m.value_or(z_m + kHalf_m)};
  return DistanceField::make(map, layer).map_error([&](const Error& error) {
    return Error{error.code, fmt::format("{}: {}; the map has {}, and the sonar is at z = {:.2f} m at the first beam: "
                                         "give the layer to use with --min-z and --max-z",
                                         command.map, error.message, bounds_text(map.bounds()), z_m)};
  });
}

LocateOptions options_of(const LocateCommand& command, const LocateMotion& motion) {
  LocateOptions options{command.localizer, command.start, command.estimation};
  options.localizer.noise = motion.noise;
  options.localizer.body_from_sonar.pretranslate(motion.sonar_moved_m);
  if (motion.water) options.localizer.sound_speed_ratio = sound_speed_ratio(*motion.water);
  return options;
}

/// nullopt: none is sure.
Result<std::optional<Trajectory>> found_trajectory(const LocatedRecording& found, const LocateCommand& command,
                                                   Console& console) {
  if (command.written == WrittenPoses::kSure) return found.known_trajectory();
  if (const std::size_t unsure = unsure_poses(found); unsure > 0) {
    console.say(
        fmt::format("{}: {} of {} poses may be wrong, while several places fit, or none does: --only-sure leaves them "
                    "out",
                    command.logs.front(), unsure, found.poses.size()));
  }
  return found.trajectory().map([](Trajectory all) { return std::optional(std::move(all)); });
}

}  // namespace

Result<int> run(const LocateCommand& command, Console& console) {
  const Stopwatch total;
  LocateSeconds seconds;
  const Stopwatch read;
  const Result<OccupancyMap> map = read_map_file(command.map);
  if (!map) return tl::unexpected(map.error());
  if (const auto inside = check_start(command, *map); !inside) return tl::unexpected(inside.error());
  Result<LocateMotion> motion = read_motion(command);
  if (!motion) return tl::unexpected(motion.error());
  for (const std::string& warning : motion->warnings) console.say(warning);
  LocateInputs inputs{.motion = *std::move(motion)};
  inputs.skipped = inputs.motion.skipped;
  Result<std::vector<Beam>> beams = read_beams(command, inputs.skipped);
  if (!beams) return tl::unexpected(beams.error());
  inputs.beams = beams->size();
  inputs.recorded_s = beams->back().time_s - beams->front().time_s;
  seconds.read = read.seconds();

  const auto first = first_pose(inputs.motion.recorded, *beams, command.logs.front());
  if (!first) return tl::unexpected(first.error());
  const Stopwatch making;
  const Result<DistanceField> field = field_of(*map, command, first->value_or(Pose::Identity()));
  if (!field) return tl::unexpected(field.error());
  inputs.field_bytes = field->memory_bytes();
  seconds.field = making.seconds();

  const Stopwatch locating;
  const LocateOptions options = options_of(command, inputs.motion);
  inputs.sound_speed_m_s = options.localizer.sound_speed_ratio * kAssumedSoundSpeed_m_s;
  ProgressBar bar(command.output_options);
  const Result<LocatedRecording> found =
      locate_recording(*std::move(beams), inputs.motion.recorded, *field, options, [&](double share) {
        if (bar.is_due()) bar.draw(share, "locating");
      });
  bar.clear();
  if (!found)
    return fail(found.error().code, fmt::format("{}: {}", name_of_input(command.logs.front()), found.error().message));
  seconds.locate = locating.seconds();

  if (found->clock_check && found->clock_check->is_apart()) {
    const char* const option = command.odometry ? "the clock of --odometry" : "--nav-offset";
    console.say(
        fmt::format("{}: {}", name_of_input(command.logs.front()), wrong_clock_text(*found->clock_check, option)));
  }
  const Result<std::optional<Trajectory>> trajectory = found_trajectory(*found, command, console);
  if (!trajectory) return tl::unexpected(trajectory.error());
  if (*trajectory) {
    inputs.written = (*trajectory)->poses().size();
    const auto done = write_file(command.output, [&](std::ostream& out) { return write_tum(**trajectory, out); });
    if (!done) return tl::unexpected(done.error());
  }
  seconds.total = total.seconds();
  const Result<void> summary = command.output_options.report == Report::kJson
                                   ? console.print(locate_json(*found, inputs, seconds))
                                   : console.summarise(locate_text(*found, command, inputs, seconds), command.output);
  if (!summary) return tl::unexpected(summary.error());
  if (!*trajectory) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: it is never sure where the vehicle was", name_of_input(command.logs.front())));
  }
  return 0;
}

}  // namespace pingvox::app
