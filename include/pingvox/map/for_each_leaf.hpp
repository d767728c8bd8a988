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

namespace detail {

template <KeyWord W, class Visitor>
void visit_leaves(const NodeView& node, const BasicKey<W>& key, const Lattice& lattice, const LeafQuery& query,
                  Visitor& visit) {
  if (query.box) {
    const Eigen::Vector3d corner = lattice.lowest_corner_of(key, node.depth());
    const double edge = lattice.cell_size_m(node.depth());
    const bool overlaps =
        (corner.array() < query.box->max.array()).all() && (corner.array() + edge > query.box->min.array()).all();
    if (!overlaps) return;
  }
  if (node.is_leaf() || node.depth() == query.max_depth) {
    visit(Leaf<W>{key, node.depth(), node.belief()});
    return;
  }
  const int bit = lattice.depth() - 1 - node.depth();
  for (int octant = 0; octant < 8; ++octant) {
    const auto child = node.child(octant);
    if (!child) continue;
    const auto with_bit = [&](W word, int axis) {
      return static_cast<W>(word | static_cast<W>(static_cast<W>((octant >> axis) & 1) << bit));
    };
    visit_leaves(*child, BasicKey<W>{with_bit(key.x, 0), with_bit(key.y, 1), with_bit(key.z, 2)}, lattice, query,
                 visit);
  }
}

}  // namespace detail

/// Calls `visit(const Leaf<W>&)` for each leaf, in the tree's order (octant by octant, x fastest).
/// REQUIRES W wide enough for the map's lattice; with_key_word picks it, WideWord always is.
template <KeyWord W, class Visitor>
void for_each_leaf(const OccupancyMap& map, const LeafQuery& query, Visitor&& visit) {
  assert(map.lattice().depth() <= kLevelsOf<W>);
  if (const auto root = map.root()) detail::visit_leaves(*root, BasicKey<W>{}, map.lattice(), query, visit);
}

}  // namespace pingvox
