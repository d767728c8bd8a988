#pragma once

#include "map/brick_tree.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::detail {

/// What is inside of a map, for the engine itself and for tests and measurements of it.
struct MapAccess {
  static const BrickTree& tree(const OccupancyMap& map) { return *map.tree_; }
  /// By default on: the map is the same either way.
  static void set_early_drop(OccupancyMap& map, EarlyDrop early_drop) { map.tree_->early_drop = early_drop; }
};

}  // namespace pingvox::detail
