#pragma once

#include <cstddef>
#include <vector>

#include "tank_echoes.hpp"

namespace pingvox::bench {

/// A lidar that spins about its upright axis.
struct LidarOptions {
  std::size_t rings = 16, steps = 1800;  ///< rays up and around
  double height_deg = 30.0;              ///< from the lowest ring to the highest, about the horizon
  std::size_t scans = 10;
};

/// What it sees in a simulated harbour of 60 x 40 m, half a metre of way between scans; rays that meet nothing within
/// 50 m are left out.
std::vector<RayCloud> lidar_scans(const LidarOptions& options);

}  // namespace pingvox::bench
