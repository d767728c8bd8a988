#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A fix (NavQuantity::kFix) in metres east, north and above another one, on the ellipsoid of WGS 84: for places within
/// some kilometres.
Eigen::Vector3d position_of_fix(const Eigen::Vector3d& fix, const Eigen::Vector3d& origin);
/// The inverse: the fix of a position in metres east, north and above another one; its longitude is in [-pi, pi].
/// REQUIRES an origin that is not at a pole
Eigen::Vector3d fix_of_position(const Eigen::Vector3d& position_m, const Eigen::Vector3d& origin);

/// Trajectory of a vehicle by its navigation log.
struct NavTrajectory {
  /// From the body to the frame of the position: x east, y north, z up [m]. It has a pose at each time of either source
  /// at which both are known, and a gap where one of them has one.
  Trajectory trajectory;
  std::string attitude, position;  ///< the names of the sources
  /// The fix at 0, 0, as NavQuantity::kFix has it; nullopt: positions are in metres in the log.
  std::optional<Eigen::Vector3d> origin_fix;
  std::string depth = {};  ///< name of the source of depth or pressure that the heights are by; empty: there is none
};

/// The sources are those of `path_sources`. A position in metres is used unchanged; fixes become metres east and north
/// of the first fix, at the depth if the log has it, else at the altitude relative to that fix.
/// @param offset_s  added to all times
/// @return kUnsupported when the log has no valid attitude or position, or never both at a time; kCorrupt when the
///         clock of one that is used was set back
Result<NavTrajectory> nav_trajectory(const NavLog& log, double offset_s = 0.0);

/// The positions alone, as poses without rotation: a reference of fixes for another trajectory.
/// The result's `attitude` is empty.
/// @return kUnsupported when the log has no valid position; kCorrupt when its clock was set back
Result<NavTrajectory> nav_positions(const NavLog& log, double offset_s = 0.0);

}  // namespace pingvox
