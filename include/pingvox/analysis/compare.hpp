#pragma once

#include <cstdint>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// When two known cells count as the same.
enum class Sameness {
  kLogOdds,    ///< equal beliefs, to the last bit
  kOccupancy,  ///< both occupied, both free or both undecided, each by its own map's thresholds
};

/// Two maps, cell by cell. Cells are of the finest resolution, whatever was pruned; sums that pass 2^64 - 1 stay there.
struct MapComparison {
  std::uint64_t same = 0, different = 0;  ///< known to both
  std::uint64_t only_a = 0, only_b = 0;   ///< known to one
  double max_log_odds_difference = 0.0;   ///< over the cells known to both

  std::uint64_t cells() const;  ///< known to either
  bool equal() const { return different == 0 && only_a == 0 && only_b == 0; }
};

/// Compares two maps by walking both trees at once: the time follows from their nodes, not from their cells.
/// @return kBadOption when the lattices differ
Result<MapComparison> compare_maps(const OccupancyMap& a, const OccupancyMap& b, Sameness sameness);

}  // namespace pingvox
