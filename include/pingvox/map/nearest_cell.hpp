#pragma once

#include <Eigen/Core>
#include <optional>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox {

/// Which cells `nearest_cell` looks for.
enum class Sought {
  kOccupied,  ///< obstacles that are known
  kNotFree,   ///< obstacles, and what is unknown or undecided: where they may be
};

/// The nearest cell of a kind; a pruned leaf counts as one cell.
struct NearestCell {
  Occupancy what = Occupancy::kOccupied;
  Eigen::Vector3d point_m;  ///< of the cell, nearest to where it was looked for; map frame
  double range_m = 0.0;     ///< to this point; 0 inside of the cell
};

/// The nearest cell of a kind around a point, in all directions. Space outside of the lattice does not count.
/// @param point_m      map frame [m], finite
/// @param max_range_m  >= 0; may be infinite
/// @return nullopt: there is none within the range
std::optional<NearestCell> nearest_cell(const OccupancyMap& map, const Eigen::Vector3d& point_m, double max_range_m,
                                        Sought sought = Sought::kOccupied);

}  // namespace pingvox
