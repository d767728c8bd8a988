#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "pingvox/geometry/trajectory.hpp"

namespace pingvox {

/// What is strange about the attitudes of a vehicle: it lies on its back nearly all the time, or it rolls over without
/// ever turning. Both come of quaternions whose numbers are in the order w, x, y, z instead of x, y, z, w. Empty:
/// nothing is, or they are too few to tell.
/// @param rpy  roll, pitch and yaw of each [rad]
std::string doubt_of_attitudes(std::span<const Eigen::Vector3d> rpy);

/// The same of the poses of a trajectory.
std::string doubt_of_poses(const Trajectory& trajectory);

}  // namespace pingvox
