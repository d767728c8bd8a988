#pragma once

#include <optional>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox {

/// A leaf of a map: the whole cell of `depth` whose lowest corner cell is `key` has this belief.
template <KeyWord W>
struct Leaf {
  BasicKey<W> key;
  int depth = 0;
  LogOdds belief;
};

struct LeafQuery {
  /// Deepest level to look at: inner nodes there are given as leaves, with what they say of their children (a coarser
  /// map of the same space). nullopt: the leaves themselves.
  std::optional<int> max_depth;
  /// Only leaves that overlap this box [m] by more than a face.
  std::optional<Box> box;
};

/// Calls `visit(const Leaf<W>&)` for each leaf, in the tree's order (octant by octant, x fastest).
/// REQUIRES W wide enough for the map's lattice; with_key_word picks it, WideWord always is.
template <KeyWord W, class Visitor>
void for_each_leaf(const OccupancyMap& map, const LeafQuery& query, Visitor&& visit);

}  // namespace pingvox
