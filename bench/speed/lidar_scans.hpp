#pragma once

#include <cstddef>
#include <vector>

#include "tank_echoes.hpp"

namespace pingvox::bench {

/// A spinning lidar.
struct LidarOptions {
  std::size_t rings = 16, steps = 1800;  ///< vertical and horizontal rays
  double height_deg = 30.0;              ///< vertical field of view, centred on the horizon
  std::size_t scans = 10;
};

/// Its scans in a simulated harbour of 60 x 40 m, 0.5 m apart; rays without a hit within 50 m are omitted.
std::vector<RayCloud> lidar_scans(const LidarOptions& options);

}  // namespace pingvox::bench
