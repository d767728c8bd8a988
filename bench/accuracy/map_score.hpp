#pragma once

#include <cstdint>

#include "accuracy/cell_grid.hpp"

namespace pingvox::bench {

/// A map held against the truth, cell by cell. Within one cell means: in the cell itself or one that touches it.
struct MapScore {
  std::uint64_t occupied = 0;        ///< cells that the map says are occupied
  std::uint64_t occupied_right = 0;  ///< of these, with a surface within one cell
  std::uint64_t visible = 0;         ///< cells with a surface that could be seen
  std::uint64_t visible_found = 0;   ///< of these, with an occupied cell of the map within one cell
  std::uint64_t free = 0;            ///< cells that the map says are free
  std::uint64_t free_right = 0;      ///< of these, water through and through
  std::uint64_t free_near = 0;       ///< of these, water within one cell: also those that a surface cuts

  double precision() const;
  double recall() const;
  double free_share() const;
  double free_share_near() const;
};

/// `visible` says kOccupied where a surface could be seen. REQUIRES grids of one size.
MapScore score_map(const CellGrid& map, const CellGrid& truth, const CellGrid& visible);

}  // namespace pingvox::bench
