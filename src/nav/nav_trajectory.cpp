#include "pingvox/nav/nav_trajectory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "pingvox/nav/main_source.hpp"

namespace pingvox {
namespace {

/// Only its valid samples. kCorrupt when its clock was set back.
Result<NavSource> valid_part(const NavSource& source) {
  if (const auto checked = check_source(source); !checked) return tl::unexpected(checked.error());
  NavSource valid = source;
  std::erase_if(valid.samples, [](const NavSample& sample) { return !sample.valid; });
  return valid;
}

/// The samples of a source as poses. Of samples with the same time the first counts.
template <class PoseOf>
Result<Trajectory> trajectory_of(const NavSource& source, double offset_s, PoseOf pose_of) {
  std::vector<StampedPose> poses;
  for (const NavSample& sample : source.samples) {
    const double time_s = sample.time_s + offset_s;
    if (poses.empty() || time_s > poses.back().time_s) poses.push_back({time_s, pose_of(sample.value)});
  }
  return Trajectory::make(std::move(poses), summary_of(source).longest_step_s).map_error([&](Error error) {
    error.message = fmt::format("{} of {}: {}", name_of(source.quantity), source.name, error.message);
    return error;
  });
}

Pose translation(const Eigen::Vector3d& position_m) {
  return Pose(Eigen::Translation3d(position_m));
}

/// Turns fixes into positions relative to the first, which is returned.
Eigen::Vector3d make_positions(NavSource& fixes) {
  const Eigen::Vector3d origin = fixes.samples.front().value;
  fixes.quantity = NavQuantity::kPosition;
  for (NavSample& sample : fixes.samples) sample.value = position_of_fix(sample.value, origin);
  return origin;
}

/// Sets the height of positions by the depth at their time; those without a depth are left out.
Result<void> set_depths(NavSource& positions, const NavSource& depth) {
  const Result<Trajectory> depths =
      trajectory_of(depth, 0.0, [](const Eigen::Vector3d& value) { return translation({0.0, 0.0, -value.x()}); });
  if (!depths) return tl::unexpected(depths.error());
  std::erase_if(positions.samples, [&](const NavSample& sample) { return !depths->at(sample.time_s); });
  for (NavSample& sample : positions.samples) sample.value.z() = depths->at(sample.time_s)->translation().z();
  return {};
}

struct PositionSource {
  NavSource source;  ///< in metres
  std::optional<Eigen::Vector3d> origin_fix;
  std::string depth = {};  ///< the source that the heights of fixes are by
};

/// nullopt: the log has no position.
Result<std::optional<PositionSource>> position_source(const NavLog& log, const NavSource* chosen) {
  if (chosen == nullptr) return std::nullopt;
  Result<NavSource> found = valid_part(*chosen);
  if (!found) return tl::unexpected(found.error());
  if (found->quantity == NavQuantity::kPosition) return PositionSource{*std::move(found), std::nullopt};
  NavSource& fixes = *found;
  const Eigen::Vector3d origin = make_positions(fixes);
  std::string depth_name;
  if (auto depth = depth_source(log)) {
    if (const auto checked = check_source(*depth); !checked) return tl::unexpected(checked.error());
    std::erase_if(depth->samples, [](const NavSample& sample) { return !sample.valid; });
    if (const auto done = set_depths(fixes, *depth); !done) return tl::unexpected(done.error());
    depth_name = depth->name;
  }
  if (fixes.samples.empty()) return std::nullopt;
  return PositionSource{std::move(fixes), origin, std::move(depth_name)};
}

/// Metres per radian of longitude and of latitude.
struct MetresPerRadian {
  double east = 0.0, north = 0.0;
};
MetresPerRadian metres_per_radian_at(double latitude_rad) {
  constexpr double kEquator_m = 6'378'137.0, kEccentricity2 = 6.694379990141e-3;
  const double sine = std::sin(latitude_rad), curved = 1.0 - kEccentricity2 * sine * sine;
  return {kEquator_m / std::sqrt(curved) * std::cos(latitude_rad),
          kEquator_m * (1.0 - kEccentricity2) / (curved * std::sqrt(curved))};
}

}  // namespace

Eigen::Vector3d position_of_fix(const Eigen::Vector3d& fix, const Eigen::Vector3d& origin) {
  const MetresPerRadian scale = metres_per_radian_at(origin.x());
  const Eigen::Vector3d moved = fix - origin;
  return {std::remainder(moved.y(), 2.0 * std::numbers::pi) * scale.east, moved.x() * scale.north, moved.z()};
}

Eigen::Vector3d fix_of_position(const Eigen::Vector3d& position_m, const Eigen::Vector3d& origin) {
  const MetresPerRadian scale = metres_per_radian_at(origin.x());
  return {origin.x() + position_m.y() / scale.north,
          std::remainder(origin.y() + position_m.x() / scale.east, 2.0 * std::numbers::pi),
          origin.z() + position_m.z()};
}

Result<NavTrajectory> nav_trajectory(const NavLog& log, double offset_s) {
  return detail::without_exceptions([&]() -> Result<NavTrajectory> {
    const PathSources sources = path_sources(log);
    const Result<std::optional<PositionSource>> found = position_source(log, sources.position);
    if (!found) return tl::unexpected(found.error());
    const NavSource* position = *found ? &(*found)->source : nullptr;
    if (sources.attitude == nullptr || position == nullptr) {
      constexpr std::array kOfPoses = {NavQuantity::kAttitude, NavQuantity::kPosition, NavQuantity::kFix};
      if (const auto checked = check_sources(log, kOfPoses); !checked) return tl::unexpected(checked.error());
      return fail(Error::Code::kUnsupported, fmt::format("has no valid {}: poses need attitude and position",
                                                         sources.attitude != nullptr ? "position" : "attitude"));
    }
    const Result<NavSource> attitude = valid_part(*sources.attitude);
    if (!attitude) return tl::unexpected(attitude.error());
    const Result<Trajectory> rotations = trajectory_of(*attitude, offset_s, [](const Eigen::Vector3d& rpy) {
      return pose_from_rpy(Eigen::Vector3d::Zero(), rpy.x(), rpy.y(), rpy.z());
    });
    if (!rotations) return tl::unexpected(rotations.error());
    const Result<Trajectory> translations = trajectory_of(*position, offset_s, translation);
    if (!translations) return tl::unexpected(translations.error());

    std::vector<double> times_s;
    for (const Trajectory* trajectory : {&*rotations, &*translations}) {
      for (const StampedPose& pose : trajectory->poses()) times_s.push_back(pose.time_s);
    }
    std::sort(times_s.begin(), times_s.end());
    times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
    std::vector<StampedPose> poses;
    for (const double time_s : times_s) {
      const std::optional<Pose> rotation = rotations->at(time_s), place = translations->at(time_s);
      if (rotation && place) poses.push_back({time_s, *place * *rotation});
    }
    if (poses.empty()) {
      return fail(Error::Code::kUnsupported, fmt::format("attitude ({}) and position ({}) are never known together",
                                                         attitude->name, position->name));
    }
    // A step with a gap in neither source is shorter than the limits of both, and one with a gap is longer than its
    // limit.
    const double longest_step_s = std::min(summary_of(*attitude).longest_step_s, summary_of(*position).longest_step_s);
    Result<Trajectory> trajectory = Trajectory::make(std::move(poses), longest_step_s);
    if (!trajectory) return tl::unexpected(trajectory.error());
    return NavTrajectory{*std::move(trajectory), attitude->name, position->name, (*found)->origin_fix, (*found)->depth};
  });
}

Result<NavTrajectory> nav_positions(const NavLog& log, double offset_s) {
  return detail::without_exceptions([&]() -> Result<NavTrajectory> {
    const Result<std::optional<PositionSource>> found = position_source(log, path_sources(log).position);
    if (!found) return tl::unexpected(found.error());
    if (!*found) {
      constexpr std::array kOfPositions = {NavQuantity::kPosition, NavQuantity::kFix};
      if (const auto checked = check_sources(log, kOfPositions); !checked) return tl::unexpected(checked.error());
      return fail(Error::Code::kUnsupported, "has no valid position");
    }
    const NavSource& position = (*found)->source;
    Result<Trajectory> trajectory = trajectory_of(position, offset_s, translation);
    if (!trajectory) return tl::unexpected(trajectory.error());
    return NavTrajectory{*std::move(trajectory), "", position.name, (*found)->origin_fix, (*found)->depth};
  });
}

}  // namespace pingvox
