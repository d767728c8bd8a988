#pragma once

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox {

/// The map without the levels below `depth`: inner nodes there become leaves with their own value
/// (MapOptions::parents). The lattice and the options stay. REQUIRES depth >= 1; from lattice().depth() on it is a
/// copy.
OccupancyMap cut_tree(const OccupancyMap& map, int depth);

}  // namespace pingvox
