#pragma once

#include <ostream>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The occupied leaves of a map as a cloud of points, binary little-endian: float x, y, z (the middle of the leaf),
/// log_odds, and size, the leaf's edge: all in metres but log_odds. Joined leaves stay joined.
Result<void> write_ply(const OccupancyMap& map, std::ostream& out);

}  // namespace pingvox
