#pragma once

#include <octomap/OcTree.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {

/// How two maps of the same space differ, in cells of the finest resolution (of whole leaves where these are larger).
struct MapDifference {
  std::uint64_t cells = 0;                     ///< that either of the two knows
  std::uint64_t differs = 0;                   ///< known in one only, or with another value
  std::uint64_t only_ours = 0, only_peer = 0;  ///< of these: known in one only
  std::uint64_t classes = 0;  ///< of these: occupied in one and free in the other, or known in one only
  std::vector<Key> keys;      ///< cells that differ, the first kMaxKeys of them
  static constexpr std::size_t kMaxKeys = 100'000;
};

/// Compares leaf by leaf: values to the last bit.
MapDifference difference(const OccupancyMap& ours, const octomap::OcTree& peer);

/// The same, or an error when a cell differs that these scans settle: see `cells_beyond_doubt`. liboctomap walks rays
/// in single precision with sums that drift, and each library is right about a cell that a ray only touches.
Result<MapDifference> alike(const OccupancyMap& ours, const octomap::OcTree& peer, std::span<const RayCloud> scans);

/// An error that says how they differ, unless both hold the same cells and values and have the same nodes.
Result<void> same_to_the_bit(const OccupancyMap& ours, const octomap::OcTree& peer);

}  // namespace pingvox::bench
