#pragma once

#include <cstdint>

#include "geometry/internal/cell_counts.hpp"
#include "pingvox/map/log_odds.hpp"

namespace pingvox::detail {

/// Adds cells of one kind to occupied_cells, free_cells or undecided_cells of `counts`, saturated.
template <class Counts>
constexpr void count_cells(Occupancy what, std::uint64_t cells, Counts& counts) {
  switch (what) {
    case Occupancy::kOccupied:
      add_saturated(counts.occupied_cells, cells);
      break;
    case Occupancy::kFree:
      add_saturated(counts.free_cells, cells);
      break;
    case Occupancy::kUnknown:
      add_saturated(counts.undecided_cells, cells);
      break;
  }
}

}  // namespace pingvox::detail
