#pragma once

#include <Eigen/Core>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox {

/// Effect of unknown cells on a ray through a map.
enum class UnknownCells {
  kBlock,  ///< the ray ends at the first one
  kPass,   ///< treated like free ones
};

/// Where a ray ended.
struct RayEnd {
  Occupancy what = Occupancy::kFree;  ///< kOccupied: hit; kUnknown: blocked; kFree: nothing within range
  WideKey key;                        ///< the cell it ended in (kFree: the last one)
  double range_m = 0.0;               ///< from the origin to where the ray enters that cell; kFree: the range it went
};

/// The first occupied cell along a ray, the cell of the origin included.
/// @param origin_m     map frame [m]; outside of the lattice the result is kUnknown at range 0
/// @param direction    finite, any length > 0
/// @param max_range_m  > 0, finite; the ray also ends, as kFree, at the border of the lattice
RayEnd cast_ray(const OccupancyMap& map, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                double max_range_m, UnknownCells unknown = UnknownCells::kPass);

}  // namespace pingvox
