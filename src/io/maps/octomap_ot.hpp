#pragma once

#include <cstddef>
#include <ostream>

#include "pingvox/io/bytes.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Reads OctoMap's tree with log-odds: OcTree, ColorOcTree (colours are ignored) or OcTreeStamped. Values of inner
/// nodes are recomputed. kUnsupported: another kind of tree; kCorrupt: any damage.
Result<OccupancyMap> read_ot(const FileBytes& file, std::size_t memory_limit_bytes);

/// Writes the same bytes as liboctomap's OcTree::write.
Result<void> write_ot(const OccupancyMap& map, MapAxes axes, std::ostream& out);

}  // namespace pingvox
