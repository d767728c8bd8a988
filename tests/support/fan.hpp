#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "map/kernels/ray_lanes.hpp"
#include "map/tree_order.hpp"

/// Fans of rays in a small window about the origin.
namespace pingvox::detail {

inline constexpr int kWindowBits = 7;  ///< 128 cells along each axis, from -64 to 63
inline constexpr std::int64_t kWindowHalf = 64;

/// A fan whose rays begin there and may go through the whole window.
inline RayFan fan_from(const Eigen::Vector3d& from_m, double cells_per_m = 1.0) {
  RayFan fan;
  fan.from = from_m * cells_per_m;
  fan.cells_per_m = cells_per_m;
  fan.window_lowest.fill(-kWindowHalf);
  fan.lowest.fill(-static_cast<double>(kWindowHalf));
  fan.highest.fill(static_cast<double>(kWindowHalf - 1));
  return fan;
}

/// Where a cell of the window stands in it. REQUIRES -64 <= cell <= 63
inline std::uint64_t place_of(const std::array<std::int64_t, 3>& cell) {
  std::uint64_t place = 0;
  for (std::size_t a = 0; a < 3; ++a) place |= spread_bits(static_cast<std::uint64_t>(cell[a] + kWindowHalf)) << a;
  return place;
}

/// The cell that a point, in cells, lies in.
inline std::array<std::int64_t, 3> cell_of(const Eigen::Vector3d& point) {
  return {static_cast<std::int64_t>(std::floor(point.x())), static_cast<std::int64_t>(std::floor(point.y())),
          static_cast<std::int64_t>(std::floor(point.z()))};
}

/// Where the cell stands in the window that the fan's rays begin in.
inline std::uint64_t start_of(const RayFan& fan) {
  return place_of(cell_of(fan.from));
}

}  // namespace pingvox::detail
