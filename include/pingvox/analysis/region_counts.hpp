#pragma once

#include <cstdint>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox {

/// Cells of the finest resolution whose middles are in a box; sums saturate at 2^64 - 1.
struct RegionCounts {
  std::uint64_t cells = 0;  ///< all, also unknown ones
  std::uint64_t occupied_cells = 0, free_cells = 0, undecided_cells = 0;
};

/// Counts the cells of a map in a box [m, map frame]. Cells outside of the lattice do not count.
RegionCounts counts_in(const OccupancyMap& map, const Box& box);

}  // namespace pingvox
