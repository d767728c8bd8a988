#pragma once

#include <ostream>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Writes the centre of each occupied leaf as a line `x y z log_odds size`, in metres.
Result<void> write_xyz(const OccupancyMap& map, std::ostream& out);

}  // namespace pingvox
