#include "pingvox/recording/vehicle_path.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/median.hpp"
#include "base/words.hpp"
#include "nav/internal/nav_frames.hpp"
#include "nav/internal/source_yaw.hpp"
#include "nav/internal/trajectory_steps.hpp"
#include "nav/internal/upright.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/tum.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "pingvox/slam/odometry.hpp"
#include "recording/move_trajectory.hpp"

namespace pingvox {
namespace {

bool has(const NavLog& nav, NavQuantity quantity) {
  return nav.best(quantity) != nullptr;
}

/// The unused sources of a log: "; unused: /aruco/pose (580 samples: ...) (nav_sources selects one)"
std::string unused_text(const NavLog& nav) {
  std::vector<std::string> taken;
  for (const NavSource& source : nav.sources()) {
    const bool is_taken = std::ranges::none_of(nav.sources(), [&](const NavSource& other) {
      return other.name == source.name && other.subject == NavSubject::kOther;
    });
    if (is_taken) taken.push_back(source.name);
  }
  constexpr std::array kAll = {NavQuantity::kPosition, NavQuantity::kFix, NavQuantity::kAttitude, NavQuantity::kHeading,
                               NavQuantity::kVelocity};
  const std::string others = text_of(other_sources(nav, kAll, taken));
  return others.empty() ? "" : fmt::format("; unused: {} (nav_sources selects one)", others);
}

std::string unused_text(const NavFiles& nav) {
  std::string text = unused_text(nav.log);
  for (const auto& [file, note] : nav.left_out) text += fmt::format("; {}: {}", file, on_one_line(note));
  for (const auto& [file, note] : nav.not_joined) text += fmt::format("; {}: {}", file, on_one_line(note));
  return text;
}

const NavSource* source_of(const NavLog& nav, NavQuantity quantity, const std::string& name) {
  const auto found = std::ranges::find_if(
      nav.sources(), [&](const NavSource& source) { return source.name == name && source.quantity == quantity; });
  return found == nav.sources().end() ? nullptr : &*found;
}

/// The heading or attitude of most samples that does not begin with the device.
const NavSource* north_source(const NavLog& nav) {
  const NavSource* most = nullptr;
  for (const NavSource& source : nav.sources()) {
    if (!has_yaw(source) || source.frame == kStartFrame || source.subject == NavSubject::kOther || !is_usable(source))
      continue;
    if (most == nullptr || source.samples.size() > most->samples.size()) most = &source;
  }
  return most;
}

/// By how much a heading is ahead of that of a trajectory: the median. nullopt: they do not agree on how it turns.
std::optional<double> yaw_ahead_of(const Trajectory& trajectory, const NavSource& heading, double offset_s) {
  constexpr std::size_t kMinSamples = 10;
  constexpr double kMaxDeviation_rad = 20.0 * kDegree_rad;
  std::vector<double> ahead_rad;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const NavSample& sample : heading.samples) {
    const std::optional<Pose> pose = trajectory.at(sample.time_s + offset_s);
    if (!sample.valid || !pose) continue;
    ahead_rad.push_back(yaw_of(heading, sample) - rpy_of(pose->rotation()).z());
    sum += Eigen::Vector2d(std::cos(ahead_rad.back()), std::sin(ahead_rad.back()));
  }
  if (ahead_rad.size() < kMinSamples) return std::nullopt;
  const double mean_rad = std::atan2(sum.y(), sum.x());
  for (double& angle_rad : ahead_rad) angle_rad = wrap_angle(angle_rad - mean_rad);
  const double middle_rad = median(ahead_rad);
  for (double& angle_rad : ahead_rad) angle_rad = std::abs(angle_rad - middle_rad);
  if (kMadToDeviation * median(ahead_rad) > kMaxDeviation_rad) return std::nullopt;
  return mean_rad + middle_rad;
}

/// By how much a trajectory is above the depth: the median; 0 where that is unknown.
double height_above_depth(const Trajectory& trajectory, const NavLog& nav, double offset_s) {
  const NavSource* const depth = nav.best(NavQuantity::kDepth);
  std::vector<double> above_m;
  if (depth == nullptr) return 0.0;
  for (const NavSample& sample : depth->samples) {
    const std::optional<Pose> pose = trajectory.at(sample.time_s + offset_s);
    if (sample.valid && pose) above_m.push_back(pose->translation().z() + sample.value.x());
  }
  return above_m.empty() ? 0.0 : median(std::move(above_m));
}

VehiclePath::Nav sources_of(const NavTrajectory& made, const NavLog& nav) {
  std::vector<NavQuantity> quantities(kPathQuantities.begin(), kPathQuantities.end());
  if (made.origin_fix) quantities.push_back(NavQuantity::kDepth);
  if (made.origin_fix && made.depth.empty()) quantities.push_back(NavQuantity::kPressure);
  return {.attitude = made.attitude,
          .position = made.position,
          .origin_fix = made.origin_fix,
          .others = other_sources(nav, quantities, std::array{made.attitude, made.position, made.depth}),
          .depth = made.depth};
}

/// @param offset_s  that was added to the times of the navigation
VehiclePath path_by(NavTrajectory made, const NavLog& nav, double offset_s) {
  VehiclePath path{.trajectory = std::move(made.trajectory), .nav = sources_of(made, nav)};
  const NavSource* const position = source_of(nav, NavQuantity::kPosition, made.position);
  const NavSource* const attitude = source_of(nav, NavQuantity::kAttitude, made.attitude);
  if (made.origin_fix || (position != nullptr && has_north(*position))) path.axes = MapAxes::kEastNorth;
  if (position == nullptr) return path;
  path.nav->frame_note = position->note;
  if (position->frame != kStartFrame) return path;
  path.axes = MapAxes::kRightAhead;
  const double above_m = height_above_depth(path.trajectory, nav, offset_s);
  path.trajectory = moved(path.trajectory, Pose(Eigen::Translation3d(0.0, 0.0, -above_m)));
  const NavSource* const north = attitude != nullptr && attitude->frame == kStartFrame ? north_source(nav) : nullptr;
  const auto ahead_rad = north != nullptr ? yaw_ahead_of(path.trajectory, *north, offset_s) : std::nullopt;
  if (!ahead_rad) return path;
  path.trajectory = moved(path.trajectory, Pose(Eigen::AngleAxisd(*ahead_rad, Eigen::Vector3d::UnitZ())));
  path.axes = MapAxes::kEastNorth;
  path.nav->north_by = north->name;
  return path;
}

Error named(const std::string& name, Error error) {
  error.message = fmt::format("{}: {}", name, error.message);
  return error;
}

Result<VehiclePath> reckon(const NavFiles& nav, const std::string& names, double offset_s,
                           const std::optional<CalibrationFile>& calibration) {
  OdometryOptions options{.body_from_source = {}, .offset_s = offset_s};
  Eigen::Vector3d sonar_moved_m = Eigen::Vector3d::Zero();
  if (calibration) {
    options.body_from_source = calibration->body_from_source;
    options.calibration = calibration->calibration;
    sonar_moved_m = sonar_moved_by(calibration->calibration);
  }
  Result<Odometry> odometry = odometry_of(nav.log, options);
  if (!odometry) {
    Error error = named(names, odometry.error());
    error.message += unused_text(nav);
    return tl::unexpected(std::move(error));
  }
  VehiclePath::Nav by{
      .attitude = odometry->heading,
      .position = {},
      .velocity = odometry->velocity,
      .others = other_sources(nav.log, kMotionQuantities, std::array{odometry->heading, odometry->velocity})};
  return VehiclePath{.trajectory = std::move(odometry->odometry_from_body),
                     .nav = std::move(by),
                     .axes = MapAxes::kEastNorth,
                     .sonar_moved_m = sonar_moved_m};
}

}  // namespace

VehiclePath still_path() {
  return {.trajectory = Trajectory::still(Pose::Identity())};
}

Result<Trajectory> read_trajectory(const InputFile& file) {
  const Result<FileBytes> bytes = file.open().and_then(ByteStream::whole);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<Trajectory> trajectory = read_tum(*bytes);
  if (trajectory) return trajectory;
  // A damaged trajectory may look like points as text.
  const std::optional<Format> format = format_of(bytes->view());
  if (!format || *format == Format::kTum || *format == Format::kXyz) return trajectory;
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: is {}, not a trajectory", bytes->name, description_of(*format)));
}

Result<VehiclePath> read_path(const InputFile& file) {
  return read_trajectory(file).and_then([&](const Trajectory& trajectory) -> Result<VehiclePath> {
    std::string doubt;
    for (const NavSource& source : sources_of_poses(trajectory)) {
      if (!source.fault.empty()) return fail(Error::Code::kCorrupt, fmt::format("{}: {}", file.name(), source.fault));
      if (!source.doubt.empty()) doubt += (doubt.empty() ? "" : "; ") + source.doubt;
    }
    CutTrajectory cut = cut_at_steps(trajectory);
    return VehiclePath{
        .trajectory = std::move(cut.trajectory), .steps = std::move(cut.steps), .doubt = std::move(doubt)};
  });
}

bool has_position(const NavLog& nav) {
  return has(nav, NavQuantity::kPosition) || has(nav, NavQuantity::kFix);
}

bool has_turns(const NavLog& nav) {
  return has(nav, NavQuantity::kAttitude) || has(nav, NavQuantity::kHeading) || has(nav, NavQuantity::kTurnRate);
}

bool has_path(const NavLog& nav) {
  return has(nav, has_position(nav) ? NavQuantity::kAttitude : NavQuantity::kVelocity);
}

Result<VehiclePath> path_of(const NavFiles& nav, const std::string& names, double offset_s,
                            const std::optional<CalibrationFile>& calibration) {
  if (!has_path(nav.log)) {
    if (const std::string faults = faults_text(nav.log); !faults.empty()) {
      return fail(Error::Code::kCorrupt, fmt::format("{}: {}", names, faults));
    }
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: gives no path: it has no valid {}{}{}", names,
                            has_position(nav.log) ? "attitude" : "position or velocity",
                            has_turns(nav.log) ? "" : ", and no heading; another log may have them", unused_text(nav)));
  }
  if (!has_position(nav.log)) return reckon(nav, names, offset_s, calibration);
  if (calibration) {
    return fail(Error::Code::kBadOption,
                "calibration: has no effect where the navigation has positions, only on dead reckoning by velocity and "
                "heading");
  }
  return nav_trajectory(nav.log, offset_s)
      .map([&](NavTrajectory made) { return path_by(std::move(made), nav.log, offset_s); })
      .map_error([&](const Error& error) { return named(names, error); });
}

Result<VehiclePath> positions_of(const BagContents& contents, const std::string& name,
                                 std::span<const NamedSource> chosen) {
  Result<NavLog> log = contents.nav.log;
  if (!chosen.empty()) log = choose_sources(contents.nav.log, chosen);
  if (!log) return fail(log.error().code, fmt::format("{}: nav_sources: {}", name, log.error().message));
  constexpr std::array kOfTurns = {NavQuantity::kAttitude};
  if (const auto checked = check_sources(*log, kOfTurns); !checked) return tl::unexpected(named(name, checked.error()));
  Result<NavTrajectory> made = has(*log, NavQuantity::kAttitude) ? nav_trajectory(*log) : nav_positions(*log);
  if (!made) {
    std::string notes;
    for (const std::string& note : contents.notes) notes += "; " + on_one_line(note);
    return fail(made.error().code, fmt::format("{}: {}{}{}", name, made.error().message, unused_text(*log), notes));
  }
  return path_by(*std::move(made), *log, 0.0);
}

}  // namespace pingvox
