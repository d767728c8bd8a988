#pragma once

#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// A trajectory without the steps that no vehicle makes.
struct CutTrajectory {
  /// It has a cut wherever the poses go on in another frame, as after the correction of a filter or of SLAM; poses that
  /// are outliers are left out.
  Trajectory trajectory;
  std::vector<SourceStep> steps;
};
/// Cuts a trajectory of any origin at each step faster than 10 m/s or one turn a second (MotionLimits).
CutTrajectory cut_at_steps(const Trajectory& trajectory);

/// The same without cuts: after each of them the poses are moved so that the vehicle is where it was before. For what
/// needs the way only, as odometry.
Trajectory join_at_cuts(const Trajectory& trajectory);

}  // namespace pingvox
