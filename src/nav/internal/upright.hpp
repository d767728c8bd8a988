#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Doubts about the attitudes of a vehicle: it lies on its back or its side nearly all the time, or it rolls
/// and never turns. That comes of quaternions whose numbers are in the order w, x, y, z instead of x, y, z, w, and of
/// roll and yaw that are swapped. Empty: none, or too few attitudes.
/// @param rpy  roll, pitch and yaw of each [rad]
std::string doubt_of_attitudes(std::span<const Eigen::Vector3d> rpy);

/// The poses of a trajectory as sources of position and attitude, with the faults and doubts of each: `fault` and
/// `doubt` as NavLog::make has them.
std::vector<NavSource> sources_of_poses(const Trajectory& trajectory);

}  // namespace pingvox
