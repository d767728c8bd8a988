#pragma once

#include <cstdint>
#include <vector>

#include "bench/bench.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::bench {

/// What a planner gets that looks no deeper than some level of a map.
struct CoarseView {
  std::uint64_t blocks = 0;           ///< nodes of that level where something is known
  std::uint64_t with_obstacle = 0;    ///< of these, those that hold an occupied cell
  std::uint64_t called_free = 0;      ///< of these, those whose own value says free: the planner goes through
  std::uint64_t called_occupied = 0;  ///< blocks whose own value says occupied
  std::uint64_t free_cells = 0;       ///< free cells of the finest resolution
  std::uint64_t free_given_up = 0;    ///< of these, those in blocks that are called occupied
  double error = 0.0;  ///< root of the mean square, over all known cells, of block's value - cell's value, in log-odds
};

/// Looks at a map from `depth`; joined leaves above it count as one block each.
CoarseView coarse_view(const OccupancyMap& map, int depth);

/// Section 5.3.1: what max and mean do to a planner that looks at depth 12.
Result<std::vector<Row>> paper_parents(const BenchOptions& options);

}  // namespace pingvox::bench
