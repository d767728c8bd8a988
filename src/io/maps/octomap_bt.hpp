#pragma once

#include <cstddef>
#include <ostream>

#include "pingvox/io/bytes.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Reads OctoMap's binary tree, also of its oldest form. Leaves get the limits of the default clamp. kCorrupt: any
/// damage.
Result<OccupancyMap> read_bt(const FileBytes& file, std::size_t memory_limit_bytes);

/// Writes the same bytes as liboctomap's OcTree::writeBinary: leaves rounded to occupied or free, and pruned. Leaves
/// between the map's thresholds are omitted, since the format cannot hold them.
Result<void> write_bt(const OccupancyMap& map, MapAxes axes, std::ostream& out);

}  // namespace pingvox
