#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "pingvox/geometry/pose2.hpp"

namespace pingvox {

/// A measured pose of node b in the frame of node a.
struct PoseEdge {
  std::size_t a = 0, b = 0;
  Pose2 a_from_b;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  ///< inverse covariance of x, y [m], yaw [rad] in a
};

/// Poses in the plane, and relative poses that were measured between them.
struct PoseGraph {
  struct Node {
    std::size_t number = 0;
    Pose2 pose;  ///< in the map
  };
  std::vector<Node> nodes;
  std::vector<PoseEdge> edges;  ///< between places in `nodes`
};

}  // namespace pingvox
