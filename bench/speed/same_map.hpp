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

/// Difference of two maps, in cells of the finest resolution.
struct MapDifference {
  std::uint64_t cells = 0;                     ///< known in either map
  std::uint64_t differs = 0;                   ///< known in one only, or with another value
  std::uint64_t only_ours = 0, only_peer = 0;  ///< of these: known in one only
  std::uint64_t classes = 0;  ///< of these: occupied in one and free in the other, or known in one only
  std::vector<Key> keys;      ///< cells that differ, the first kMaxKeys of them
  static constexpr std::size_t kMaxKeys = 100'000;
};

/// Compares leaf by leaf, values exactly.
MapDifference difference(const OccupancyMap& ours, const octomap::OcTree& peer);

/// Difference of the maps; an error if a cell differs that rounding cannot explain (cells_beyond_rounding).
Result<MapDifference> check_equal(const OccupancyMap& ours, const octomap::OcTree& peer,
                                  std::span<const RayCloud> scans);

/// An error with the difference unless both maps have the same cells, values and nodes.
Result<void> check_identical(const OccupancyMap& ours, const octomap::OcTree& peer);

}  // namespace pingvox::bench
