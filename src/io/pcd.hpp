#pragma once

#include <ostream>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Writes the occupied leaves of a map as PCD 0.7, binary, with the values of write_ply.
Result<void> write_pcd(const OccupancyMap& map, std::ostream& out);

}  // namespace pingvox
