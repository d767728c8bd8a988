#pragma once

#include <cstdint>
#include <optional>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::app {

/// Where two maps agree on what is occupied and what is free, each by its own thresholds. Cells are of the finest
/// resolution; sums that pass 2^64 - 1 stay there.
struct MapAgreement {
  std::uint64_t occupied_a = 0, occupied_b = 0, occupied_both = 0;
  std::uint64_t free_a = 0, free_b = 0, free_both = 0;
  /// Occupied cells of A with one of B in the same place or touching it (by a face, an edge or a corner), and the other
  /// way round; nullopt where there are too many occupied cells to look around each.
  std::optional<std::uint64_t> a_near_b, b_near_a;

  static constexpr std::uint64_t kMaxLookedAround = 20'000'000;

  /// B taken for the truth: shares, nullopt where nothing is to be shared.
  std::optional<double> precision() const;  ///< of A's occupied cells, those within one cell of one of B's
  std::optional<double> recall() const;     ///< of B's occupied cells, those within one cell of one of A's
  std::optional<double> free_true() const;  ///< of A's free cells, those that are free in B
};

/// REQUIRES maps of the same lattice.
MapAgreement agreement_of(const OccupancyMap& a, const OccupancyMap& b);

}  // namespace pingvox::app
