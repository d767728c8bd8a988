#pragma once

#include <cstdint>
#include <optional>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox {

/// Which cells an agreement counts.
struct AgreementOptions {
  std::optional<Box> box;                 ///< only cells with their middle in it; nullopt: all
  const OccupancyMap* visible = nullptr;  ///< recall counts only its occupied cells; nullptr: all of B
  std::uint32_t near_cells = 1;           ///< cells at most so many apart along each axis are near each other
};

/// Agreement of two maps on occupied and free cells, each by its own thresholds. Cells are of the finest
/// resolution; sums that pass 2^64 - 1 stay there. `near` means within AgreementOptions::near_cells, usually in the
/// same place or touching it (by a face, an edge or a corner); these counts are nullopt where there are too many cells
/// to look around each.
struct MapAgreement {
  std::uint64_t occupied_a = 0, occupied_b = 0, occupied_both = 0;
  std::uint64_t free_a = 0, free_b = 0, free_both = 0;
  std::uint64_t to_find = 0;                ///< occupied cells of B, or those that could be seen
  std::optional<std::uint64_t> a_near_b;    ///< occupied cells of A near an occupied one of B
  std::optional<std::uint64_t> found_by_a;  ///< cells to find near an occupied one of A
  std::optional<std::uint64_t> free_near;   ///< free cells of A near a free one of B

  static constexpr std::uint64_t kMaxLookedAround = 20'000'000;

  /// B taken as ground truth: shares, nullopt where there is nothing to divide by.
  std::optional<double> precision() const;       ///< of A's occupied cells, those near one of B's
  std::optional<double> recall() const;          ///< of the cells to find, those near one of A's
  std::optional<double> free_true() const;       ///< of A's free cells, those that are free in B
  std::optional<double> free_true_near() const;  ///< of A's free cells, those near a free one of B
};

/// REQUIRES maps of the same lattice, `options.visible` too.
MapAgreement agreement_of(const OccupancyMap& a, const OccupancyMap& b, const AgreementOptions& options = {});

/// The same map with other thresholds for occupied and free.
OccupancyMap with_thresholds(const OccupancyMap& map, const Thresholds& thresholds);

/// The box in which ground truth can judge a map: all of its known cells, and `behind_m` more behind its walls. A side
/// without a wall (the surface above, the mouth of a harbour), where the farthest free cells have no occupied ones
/// behind them, ends with these: beyond, ground truth is unknown. nullopt: the map is empty.
std::optional<Box> judged_box(const OccupancyMap& truth, double behind_m = 3.0);

}  // namespace pingvox
