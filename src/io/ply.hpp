#pragma once

#include <ostream>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Writes the occupied leaves of a map as points, binary little-endian: float x, y, z (centre of the leaf) [m],
/// log_odds, and size of the leaf [m].
Result<void> write_ply(const OccupancyMap& map, std::ostream& out);

}  // namespace pingvox
