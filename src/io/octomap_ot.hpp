#pragma once

#include <cstddef>
#include <ostream>

#include "pingvox/io/bytes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// OctoMap's tree with log-odds: OcTree, ColorOcTree (colours are left out) or OcTreeStamped. kUnsupported: another
/// kind of tree; kCorrupt: any damage. What inner nodes say is made anew from their children.
Result<OccupancyMap> read_ot(const FileBytes& file, std::size_t memory_limit_bytes);

/// The bytes that liboctomap's OcTree::write writes for the same tree.
Result<void> write_ot(const OccupancyMap& map, std::ostream& out);

}  // namespace pingvox
