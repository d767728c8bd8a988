#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "pingvox/geometry/pose2.hpp"
#include "pingvox/geometry/pose_graph.hpp"

namespace pingvox {

/// Difference between where the poses put b in the frame of a, and the edge: x, y [m], yaw [rad].
Eigen::Vector3d residual_of(const PoseEdge& edge, const Pose2& a, const Pose2& b);

/// Moves poses to the least sum of squares of the edges; loops have Cauchy's loss, so that a wrong one has little
/// effect. The first pose is fixed. REQUIRES edges between these poses.
/// @param poses  where to begin; at least one
/// @param odometry  from each pose to the next
/// @return the final weights of the loops, 0..1 each
std::vector<double> solve_pose_graph(std::vector<Pose2>& poses, std::span<const PoseEdge> odometry,
                                     std::span<const PoseEdge> loops);

}  // namespace pingvox
