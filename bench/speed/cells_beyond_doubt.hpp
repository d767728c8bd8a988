#pragma once

#include <span>
#include <vector>

#include "pingvox/geometry/lattice.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {

/// Of these cells, those about which no scan leaves a doubt. A scan leaves one where rounding may decide: when no ray
/// surely ends in the cell, and one may, or when no ray surely passes through it, and one may touch it. A ray is sure
/// of a cell that it meets also when the cell is made a hundredth smaller on all sides, and may touch one that it meets
/// when the cell is made as much larger.
std::vector<Key> cells_beyond_doubt(const Lattice& lattice, std::span<const RayCloud> scans,
                                    std::span<const Key> cells);

}  // namespace pingvox::bench
