#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox {

/// A leaf of a map: the whole cell of `depth` whose lowest corner cell is `key` has this belief. Valid as long as the
/// map.
struct Leaf {
  WideKey key;
  int depth = 0;
  LogOdds belief;
  const Lattice* lattice = nullptr;

  Eigen::Vector3d centre_m() const { return lattice->centre_of(key, depth); }  ///< map frame
  double edge_m() const { return lattice->cell_size_m(depth); }
};

struct LeafQuery {
  /// Deepest level to visit: inner nodes there are visited as leaves with their own value (a coarser map of the same
  /// space). nullopt: the leaves themselves.
  std::optional<int> max_depth;
  /// Only leaves that overlap this box [m] by more than a face.
  std::optional<Box> box;
};

namespace detail {

/// Positions of the cells of a brick.
inline constexpr auto kPlaces = [] {
  std::array<BasicKey<std::uint8_t>, 64> places{};
  for (std::size_t cell = 0; cell < places.size(); ++cell) {
    const auto word = [&](int axis) {
      return static_cast<std::uint8_t>((cell >> axis & 1) | (cell >> (axis + 2) & 2));
    };
    places[cell] = {word(0), word(1), word(2)};
  }
  return places;
}();

/// Which nodes a walk enters. Separate types, so that a walk over the whole map pays nothing for the test.
struct Everywhere {
  template <KeyWord W>
  bool overlaps(const BasicKey<W>&, int) const {
    return true;
  }
  template <KeyWord W>
  bool contains(const BasicKey<W>&, int) const {
    return true;
  }
};
class InBox {
 public:
  InBox(const Lattice& lattice, const Box& box) : lattice_(lattice), box_(box) {}

  template <KeyWord W>
  bool overlaps(const BasicKey<W>& key, int depth) const {
    if (depth < 0) return true;
    const Eigen::Vector3d corner = lattice_.lowest_corner_of(key, depth);
    const double edge = lattice_.cell_size_m(depth);
    return (corner.array() < box_.max.array()).all() && (corner.array() + edge > box_.min.array()).all();
  }

  /// Whether all below a node is entered.
  template <KeyWord W>
  bool contains(const BasicKey<W>& key, int depth) const {
    if (depth < 0) return false;
    const Eigen::Vector3d corner = lattice_.lowest_corner_of(key, depth);
    const double edge = lattice_.cell_size_m(depth);
    return (corner.array() >= box_.min.array()).all() && (corner.array() + edge <= box_.max.array()).all();
  }

 private:
  const Lattice& lattice_;
  Box box_;
};

/// Goes down a tree, entry by entry; in a brick from bit to bit. Depths are those of the lattice: a lattice of one
/// level has a brick at depth -1, of which only octant 0 is used.
template <KeyWord W, class Where, class Visitor>
class LeafWalk {
 public:
  LeafWalk(const OccupancyMap& map, std::optional<int> max_depth, const Where& where, Visitor& visit)
      : tree_(view_of(map)),
        lattice_(map.lattice()),
        lattice_depth_(lattice_.depth()),
        parents_(map.options().parents),
        max_depth_(max_depth),
        where_(where),
        visitor_(visit) {}

  void visit(const Entry& entry, const BasicKey<W>& key, int depth) {
    if (entry.is_none() || !where_.overlaps(key, depth)) return;
    if (entry.is_leaf() || depth == max_depth_) {
      give(key, depth, entry.value);
      return;
    }
    if (depth == lattice_depth_ - 2) {
      visit(tree_.bricks[entry.link], key, depth);
      return;
    }
    const Group& group = tree_.groups[entry.link];
    for (std::size_t octant = 0; octant < 8; ++octant) visit(group.child[octant], below(key, depth, octant), depth + 1);
  }

 private:
  static constexpr std::uint64_t kFirstCells = 0x0101010101010101;  ///< of each octant

  void visit(BrickView brick, const BasicKey<W>& key, int depth) {
    if (depth + 1 == max_depth_) {
      visit_octants(brick, key, depth);
      return;
    }
    const std::uint64_t joined = tree_.pruned ? cells_of_uniform_octants(brick) : 0;
    const bool is_within = where_.contains(key, depth);
    // Of joined cells the first stands for all.
    for (std::uint64_t left = brick.known & (~joined | kFirstCells); left != 0; left &= left - 1) {
      const auto cell = static_cast<std::size_t>(std::countr_zero(left));
      const int leaf_depth = depth + ((joined >> cell) & 1 ? 1 : 2);
      const BasicKey<W> leaf_key = cell_below(key, cell);
      const BasicKey<W> octant_key = cell_below(key, cell & ~std::size_t{7});
      if (!is_within && (!where_.overlaps(octant_key, depth + 1) || !where_.overlaps(leaf_key, leaf_depth))) continue;
      give(leaf_key, leaf_depth, brick.value[cell]);
    }
  }

  void visit_octants(BrickView brick, const BasicKey<W>& key, int depth) {
    for (std::size_t octant = 0; octant < 8; ++octant) {
      if ((brick.known >> (octant * 8) & 0xFF) == 0) continue;
      const BasicKey<W> octant_key = cell_below(key, octant * 8);
      if (!where_.overlaps(octant_key, depth + 1)) continue;
      give(octant_key, depth + 1, summary_of_octant(brick, static_cast<int>(octant), parents_));
    }
  }

  /// The cell of a brick whose lowest one is `key`.
  static BasicKey<W> cell_below(const BasicKey<W>& key, std::size_t cell) {
    const BasicKey<std::uint8_t>& place = kPlaces[cell];
    return {static_cast<W>(key.x | place.x), static_cast<W>(key.y | place.y), static_cast<W>(key.z | place.z)};
  }

  BasicKey<W> below(const BasicKey<W>& key, int depth, std::size_t octant) const {
    const int bit = lattice_depth_ - 1 - depth;
    const auto with_bit = [&](W word, int axis) {
      return static_cast<W>(word | static_cast<W>(static_cast<W>((octant >> axis) & 1) << bit));
    };
    return {with_bit(key.x, 0), with_bit(key.y, 1), with_bit(key.z, 2)};
  }

  void give(const BasicKey<W>& key, int depth, float belief) {
    visitor_(Leaf{key.template as<WideWord>(), depth, LogOdds(belief), &lattice_});
  }

  TreeView tree_;
  const Lattice& lattice_;
  int lattice_depth_;
  Parents parents_;
  std::optional<int> max_depth_;
  Where where_;
  Visitor& visitor_;
};

}  // namespace detail

/// Calls `visit(const Leaf&)` for each leaf, in the tree's order (octant by octant, x fastest).
template <class Visitor>
void for_each_leaf(const OccupancyMap& map, const LeafQuery& query, Visitor&& visit) {
  const auto walk = [&]<KeyWord W, class Where>(const BasicKey<W>& root, const Where& where) {
    const detail::TreeView tree = detail::view_of(map);
    detail::LeafWalk<W, Where, std::remove_reference_t<Visitor>>(map, query.max_depth, where, visit)
        .visit(tree.root, root, -tree.extra_levels);
  };
  const auto walk_by = [&]<KeyWord W>(const BasicKey<W>& root) {
    if (query.box) return walk(root, detail::InBox(map.lattice(), *query.box));
    walk(root, detail::Everywhere{});
  };
  // Keys of 64 bits are quicker.
  if (map.lattice().depth() <= kLevelsOf<std::uint64_t>) return walk_by(BasicKey<std::uint64_t>{});
  walk_by(WideKey{});
}
template <class Visitor>
void for_each_leaf(const OccupancyMap& map, Visitor&& visit) {
  for_each_leaf(map, LeafQuery{}, std::forward<Visitor>(visit));
}

}  // namespace pingvox
