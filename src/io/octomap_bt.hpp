#pragma once

#include <cstddef>
#include <ostream>

#include "pingvox/io/bytes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// OctoMap's binary tree, also in its oldest form. Leaves get the limits of the default clamp. kCorrupt: any damage.
Result<OccupancyMap> read_bt(const FileBytes& file, std::size_t memory_limit_bytes);

/// The bytes that liboctomap's OcTree::writeBinary writes: each leaf occupied or free, equal ones joined. The map stays
/// as it is. Leaves between the map's thresholds are left out: the format has no third value.
Result<void> write_bt(const OccupancyMap& map, std::ostream& out);

}  // namespace pingvox
