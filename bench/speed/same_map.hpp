#pragma once

#include <octomap/OcTree.h>

#include <cstdint>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox::bench {

/// How two maps of the same space differ, in cells of the finest resolution (of whole leaves where these are larger).
struct MapDifference {
  std::uint64_t cells = 0;                     ///< that either of the two knows
  std::uint64_t differs = 0;                   ///< known in one only, or with another value
  std::uint64_t only_ours = 0, only_peer = 0;  ///< of these: known in one only
  std::uint64_t classes = 0;  ///< of these: occupied in one and free in the other, or known in one only
  double share() const { return cells == 0 ? 0.0 : static_cast<double>(differs) / static_cast<double>(cells); }
};

/// Compares leaf by leaf: values to the last bit.
MapDifference difference(const OccupancyMap& ours, const octomap::OcTree& peer);

/// The same, or an error when a larger share than `tolerated` differs.
Result<MapDifference> alike(const OccupancyMap& ours, const octomap::OcTree& peer, double tolerated);

/// An error that says how they differ, unless both hold the same cells and values and have the same nodes.
Result<void> same_to_the_bit(const OccupancyMap& ours, const octomap::OcTree& peer);

}  // namespace pingvox::bench
