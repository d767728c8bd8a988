#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <memory>
#include <utility>

#include "io/internal/beams_in_order.hpp"
#include "nav/internal/trajectory_steps.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/slam/odometry.hpp"

namespace pingvox {
namespace {

using Clock = std::chrono::steady_clock;

/// Seconds since `start`, which is reset.
double lap_s(Clock::time_point& start) {
  const Clock::time_point now = Clock::now();
  return std::chrono::duration<double>(now - std::exchange(start, now)).count();
}

std::string shown_name(const Recording& recording) {
  const InputFile& log = recording.logs().front();
  return log.is_standard_input() ? std::string(ByteStream::kStandardInput) : log.name();
}

/// The motion by odometry in a file: only the way counts, and a step is none.
Result<RecordedMotion> motion_of_poses(const InputFile& poses, RecordingLocation& location) {
  return read_trajectory(poses).map([&](const Trajectory& odometry) {
    location.odometry_poses = odometry.poses().size();
    CutTrajectory cut = cut_at_steps(odometry);
    location.steps = std::move(cut.steps);
    return RecordedMotion{join_at_cuts(cut.trajectory), std::nullopt, {}};
  });
}

/// The motion by velocity and heading of the navigation.
Result<RecordedMotion> motion_of_nav(const Recording& recording, RecordingLocation& location) {
  const RecordingOptions& of = recording.options();
  OdometryOptions options{
      .body_from_source = of.nav_mounts, .offset_s = recording.nav_offset()->offset_s, .turns = TurnsBy::kTurnRate};
  if (of.calibration) {
    options.body_from_source.insert(of.calibration->body_from_source.begin(), of.calibration->body_from_source.end());
    options.calibration = of.calibration->calibration;
  }
  const NavLog& log = recording.nav().log;
  Result<Odometry> odometry = odometry_of(log, options);
  if (!odometry) {
    return fail(odometry.error().code, fmt::format("{}: {}", recording.nav_names(), odometry.error().message));
  }
  location.velocity = odometry->velocity;
  location.heading = odometry->heading;
  location.others = other_sources(log, kMotionQuantities, std::array{odometry->velocity, odometry->heading});
  RecordedMotion motion{std::move(odometry->odometry_from_body), std::nullopt, {}};
  if (!odometry->velocity.empty()) {
    motion.nav = log;
    motion.nav_options = std::move(options);
  }
  return motion;
}

Result<RecordedMotion> motion_of(const Recording& recording, RecordingLocation& location) {
  if (recording.options().poses) return motion_of_poses(*recording.options().poses, location);
  if (recording.options().nav.empty()) return RecordedMotion{};
  return motion_of_nav(recording, location);
}

/// The beams of all logs, at least one.
Result<std::vector<Beam>> beams_of(const Recording& recording, std::size_t& skipped) {
  std::vector<Beam> beams;
  for (std::size_t i = 0; i < recording.logs().size(); ++i) {
    Result<OpenedLog> log = recording.open_log(i);
    if (!log) return tl::unexpected(log.error());
    const std::string name = log->name;
    Result<std::unique_ptr<BeamSource>> source = only_beams(std::move(log->log), name);
    if (!source) return tl::unexpected(source.error());
    if (!recording.options().nav.empty()) {
      if (const auto has = check_has_times(**source, name); !has) return tl::unexpected(has.error());
    }
    const std::unique_ptr<BeamSource> ordered = in_order(*std::move(source), name);
    Result<std::vector<Beam>> read = read_all(*ordered);
    if (!read) return tl::unexpected(read.error());
    skipped += ordered->skipped();
    std::ranges::move(*read, std::back_inserter(beams));
  }
  if (beams.empty()) {
    return fail(Error::Code::kUnsupported, fmt::format("{}: there are no beams", shown_name(recording)));
  }
  return beams;
}

/// Pose of the odometry at the first beam that has one; without odometry the origin.
/// @return kUnsupported when none has
Result<Pose> first_pose(const RecordedMotion& motion, const std::vector<Beam>& beams, const std::string& log) {
  const auto& odometry = motion.odometry_from_body;
  if (!odometry) return Pose::Identity();
  for (const Beam& beam : beams) {
    if (auto pose = odometry->at(beam.time_s)) return *pose;
  }
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: beams and navigation do not overlap in time: the beams are from {:.3f} to {:.3f} s, "
                          "the navigation is from {:.3f} to {:.3f} s",
                          log, beams.front().time_s, beams.back().time_s, odometry->poses().front().time_s,
                          odometry->poses().back().time_s));
}

/// The distance field of the layer of the map around the sonar at the first beam.
Result<DistanceField> field_of(const OccupancyMap& map, const RecordingLocateOptions& options, double z_m) {
  constexpr double kHalf_m = 0.5;
  const DistanceFieldOptions layer{options.min_z_m.value_or(z_m - kHalf_m), options.max_z_m.value_or(z_m + kHalf_m)};
  return DistanceField::make(map, layer).map_error([&](const Error& error) {
    std::string reach = "is empty";
    if (const std::optional<Box> box = map.bounds()) {
      reach = fmt::format("has x {:.9g}..{:.9g}, y {:.9g}..{:.9g}, z {:.9g}..{:.9g} m", box->min.x(), box->max.x(),
                          box->min.y(), box->max.y(), box->min.z(), box->max.z());
    }
    return Error{error.code, fmt::format("{}: {}; the map {}, and the sonar is at z = {:.2f} m at the first beam: give "
                                         "the layer to use with min_z_m and max_z_m",
                                         options.map_name, error.message, reach, z_m)};
  });
}

}  // namespace

Result<RecordingLocation> locate(const Recording& recording, const OccupancyMap& map,
                                 const RecordingLocateOptions& options, const std::function<void(double)>& progress) {
  if (!recording.nav_offset()) return tl::unexpected(recording.nav_offset().error());
  Clock::time_point start = Clock::now();
  RecordingLocation location;
  location.skipped = recording.nav().damaged;
  const Result<RecordedMotion> motion = motion_of(recording, location);
  if (!motion) return tl::unexpected(motion.error());
  Result<std::vector<Beam>> beams = beams_of(recording, location.skipped);
  if (!beams) return tl::unexpected(beams.error());
  location.beams = beams->size();
  location.recorded_s = beams->back().time_s - beams->front().time_s;
  location.read_s = lap_s(start);

  const RecordingOptions& of = recording.options();
  const Result<Pose> first = first_pose(*motion, *beams, recording.logs().front().name());
  if (!first) return tl::unexpected(first.error());
  const Result<DistanceField> field = field_of(map, options, (*first * of.body_from_sonar.translation()).z());
  if (!field) return tl::unexpected(field.error());
  location.field_bytes = field->memory_bytes();
  location.field_s = lap_s(start);

  location.options = options.locate;
  LocalizerOptions& localizer = location.options.localizer;
  localizer.body_from_sonar = of.body_from_sonar;
  if (of.calibration) localizer.body_from_sonar.pretranslate(sonar_moved_by(of.calibration->calibration));
  if (!of.nav.empty() && location.velocity.empty()) localizer.noise = MotionNoise::turns_only();
  if (recording.water()) localizer.sound_speed_ratio = sound_speed_ratio(*recording.water());
  Result<LocatedRecording> found = locate_recording(*std::move(beams), *motion, *field, location.options, progress);
  if (!found) return fail(found.error().code, fmt::format("{}: {}", shown_name(recording), found.error().message));
  location.found = *std::move(found);
  location.locate_s = lap_s(start);
  return location;
}

}  // namespace pingvox
