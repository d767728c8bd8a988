#pragma once

#include <string>

#include "pingvox/result.hpp"

namespace pingvox {

/// What LiveMapping publishes as topics of ROS 2: the map (octomap_binary, octomap_full, octomap_point_cloud_centers,
/// projected_map) when it has changed, each pose as `odometry` and, without the prefix, as `tf`.
struct Ros2Publish {
  /// Before the names of topics, as in "pingvox" for "/pingvox/octomap_binary". Empty: "/octomap_binary".
  std::string prefix = {};
  std::string frame = "map", body_frame = "base_link";
  /// Shortest time from one map to the next; longer where writing one takes more than a tenth of it.
  double every_s = 2.0;

  Result<void> validate() const;  ///< kBadOption names every broken field at once
  /// "/octomap_binary" with the prefix.
  std::string topic(const std::string& name) const;
};

}  // namespace pingvox
