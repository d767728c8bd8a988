#pragma once

#include "map/brick_tree.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::detail {

/// Access to the storage of a map, for the engine, its tests and benchmarks.
struct MapAccess {
  static const BrickTree& tree(const OccupancyMap& map) { return *map.tree_; }
  /// By default on: the map is the same either way.
  static void set_early_drop(OccupancyMap& map, EarlyDrop early_drop) { map.tree_->early_drop = early_drop; }
};

}  // namespace pingvox::detail
