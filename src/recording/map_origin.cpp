#include "pingvox/recording/map_origin.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "base/median.hpp"
#include "pingvox/nav/main_source.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "recording/moved_to_origin.hpp"

namespace pingvox {

std::optional<MapOrigin> map_origin(const VehiclePath& path, const NavLog& nav, double offset_s) {
  using Heights = MapOrigin::Heights;
  if (!path.nav) return std::nullopt;
  if (path.nav->origin_fix) {
    return MapOrigin{*path.nav->origin_fix, path.nav->depth.empty() ? Heights::kAboveFix : Heights::kOwn};
  }
  const NavSource* const fixes = main_source(nav, NavQuantity::kFix);
  if (path.axes != MapAxes::kEastNorth || !path.nav->velocity.empty() || fixes == nullptr) return std::nullopt;
  constexpr std::size_t kMinFixes = 10;
  std::optional<Eigen::Vector3d> first;
  std::vector<double> east_m, north_m;
  for (const NavSample& sample : fixes->samples) {
    const std::optional<Pose> pose = path.trajectory.at(sample.time_s + offset_s);
    if (!sample.valid || !pose) continue;
    if (!first) first = sample.value;
    const Eigen::Vector3d apart_m = position_of_fix(sample.value, *first) - pose->translation();
    east_m.push_back(apart_m.x());
    north_m.push_back(apart_m.y());
  }
  if (east_m.size() < kMinFixes) return std::nullopt;
  return MapOrigin{fix_of_position({median(std::move(east_m)), median(std::move(north_m)), 0.0}, *first),
                   Heights::kOwn};
}

VehiclePath moved_to_origin(VehiclePath path, const MapOrigin& from, const MapOrigin& to) {
  using Heights = MapOrigin::Heights;
  if (path.nav) path.nav->origin_fix = to.fix;
  if (from.fix == to.fix) return path;
  const bool are_above_fixes = from.heights == Heights::kAboveFix && to.heights == Heights::kAboveFix;
  std::vector<StampedPose> poses = path.trajectory.poses();
  for (StampedPose& pose : poses) {
    const Eigen::Vector3d own = pose.map_from_body.translation();
    Eigen::Vector3d moved = position_of_fix(fix_of_position(own, from.fix), to.fix);
    if (!are_above_fixes) moved.z() = own.z();
    pose.map_from_body.translation() = moved;
  }
  path.trajectory = *Trajectory::make(std::move(poses), path.trajectory.longest_step_s(), path.trajectory.cuts());
  return path;
}

}  // namespace pingvox
