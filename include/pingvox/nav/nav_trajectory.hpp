#pragma once

#include <Eigen/Core>
#include <string>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A fix (NavQuantity::kFix) in metres east, north and above another one, on the ellipsoid of WGS 84: for places within
/// some kilometres.
Eigen::Vector3d position_of_fix(const Eigen::Vector3d& fix, const Eigen::Vector3d& origin);

/// Where a vehicle was, as its log says.
struct NavTrajectory {
  /// From the body to the frame of the position: x east, y north, z up [m]. It has a pose at each time of either source
  /// at which both are known, and a gap where one of them has one.
  Trajectory trajectory;
  std::string attitude, position;  ///< the names of the sources
};

/// Of each quantity the estimate of the autopilot's main filter, else the source with most valid samples; before that,
/// an attitude that comes with the position. A position in metres is taken as it is; a log without one gives fixes as
/// metres east and north of the first fix, at the depth where the log has it, else at the altitude relative to that
/// fix.
/// @param offset_s  added to all times
/// @return kUnsupported when the log has no valid attitude or position, or never both at a time
Result<NavTrajectory> nav_trajectory(const NavLog& log, double offset_s = 0.0);

/// The positions alone, as poses that are not turned: the reference that fixes are for another trajectory. `attitude`
/// is empty.
/// @return kUnsupported when the log has no valid position
Result<NavTrajectory> nav_positions(const NavLog& log, double offset_s = 0.0);

}  // namespace pingvox
