#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace pingvox {

/// Poses in the plane, and relative poses that were measured between them.
struct PoseGraph {
  struct Node {
    std::size_t number = 0;
    Eigen::Vector3d pose = Eigen::Vector3d::Zero();  ///< x, y [m] and yaw [rad] in the map
  };
  /// Measured pose of node b in the frame of node a.
  struct Edge {
    std::size_t a = 0, b = 0;  ///< places in `nodes`
    Eigen::Vector3d a_from_b = Eigen::Vector3d::Zero();
    Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  ///< inverse covariance of a_from_b
  };
  std::vector<Node> nodes;
  std::vector<Edge> edges;
};

}  // namespace pingvox
