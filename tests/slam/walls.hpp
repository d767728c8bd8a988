#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace pingvox::test {

/// A line from ax, ay to bx, by [m], seen from above.
using Wall = std::array<double, 4>;

/// Distance to the nearest wall in a direction; infinite where there is none.
inline double range_to_walls_m(std::span<const Wall> walls, const Eigen::Vector2d& from, double yaw_rad) {
  const Eigen::Vector2d ray(std::cos(yaw_rad), std::sin(yaw_rad));
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [ax, ay, bx, by] : walls) {
    const Eigen::Vector2d a(ax, ay), wall(bx - ax, by - ay), to = a - from;
    const double det = ray.x() * wall.y() - ray.y() * wall.x();
    if (det == 0.0) continue;
    const double range = (to.x() * wall.y() - to.y() * wall.x()) / det;
    const double share = (to.x() * ray.y() - to.y() * ray.x()) / det;
    if (range > 0.0 && share >= 0.0 && share <= 1.0) nearest = std::min(nearest, range);
  }
  return nearest;
}

}  // namespace pingvox::test
