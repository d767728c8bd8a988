#pragma once

#include <cstdint>
#include <vector>

#include "bench/bench.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::bench {

/// A map as seen by a planner at a coarse level.
struct CoarseView {
  std::uint64_t blocks = 0;           ///< known nodes of that level
  std::uint64_t with_obstacle = 0;    ///< of these, nodes with an occupied cell
  std::uint64_t called_free = 0;      ///< of these, nodes classified as free: the planner goes through
  std::uint64_t called_occupied = 0;  ///< nodes classified as occupied
  std::uint64_t free_cells = 0;       ///< free cells of the finest resolution
  std::uint64_t free_given_up = 0;    ///< of these, in nodes classified as occupied
  double error = 0.0;                 ///< RMS over all known cells of (node - cell), in log-odds
};

/// Evaluates a map at `depth`; leaves above it count as one node each.
CoarseView coarse_view(const OccupancyMap& map, int depth);

/// Section 5.3.1: effect of max and mean on a planner at depth 12.
Result<std::vector<Row>> paper_parents(const BenchOptions& options);

}  // namespace pingvox::bench
