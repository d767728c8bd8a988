#pragma once

#include <Eigen/Geometry>

namespace pingvox {

/// A rigid transform, named `to_from`: `map_from_sensor * p_sensor` is p in the map frame. Frames follow ROS REP-103:
/// x ahead, y left, z up, angles counter-clockwise, metres.
using Pose = Eigen::Isometry3d;

/// Pose from a position and fixed-axis roll, pitch, yaw [rad]: rotate about x, then y, then z (REP-103).
Pose pose_from_rpy(const Eigen::Vector3d& position_m, double roll_rad, double pitch_rad, double yaw_rad);

/// The angles of pose_from_rpy [rad]: pitch in [-pi/2, pi/2], the others in [-pi, pi]. REQUIRES a rotation.
Eigen::Vector3d rpy_of(const Eigen::Matrix3d& rotation);

/// Between two poses: position linearly, rotation along the shortest great arc. `share` 0 gives `a`, 1 gives `b`.
Pose interpolate(const Pose& a, const Pose& b, double share);

}  // namespace pingvox
