#pragma once

#include <span>
#include <vector>

#include "pingvox/geometry/lattice.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {

/// Selects the cells whose state in the scans cannot depend on rounding. It can if no ray ends in (or passes through)
/// the cell shrunk by a hundredth on all sides, but one does in the cell grown by as much.
std::vector<Key> cells_beyond_rounding(const Lattice& lattice, std::span<const RayCloud> scans,
                                       std::span<const Key> cells);

}  // namespace pingvox::bench
