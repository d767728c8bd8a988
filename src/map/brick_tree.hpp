#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "map/bits.hpp"
#include "map/brick.hpp"
#include "map/pool.hpp"
#include "pingvox/geometry/key.hpp"
#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/tree_view.hpp"

namespace pingvox {

/// Whether an update that cannot change a cell is dropped before anything above the cell is touched (paper, section
/// 5.3). The map is the same either way.
enum class EarlyDrop { kOn, kOff };

namespace detail {

/// Lookup cache: the 2 x 2 x 2 block of equal nodes that covers all known space. Nodes as wide as the map suffice for
/// such a block, wherever the map lies, and the tree hardly branches between the root and the block.
struct Shortcut {
  int level;                       ///< the nodes are 2^level cells wide
  BasicKey<std::uint64_t> lowest;  ///< the lowest node: its cells' keys, shifted right by `level`
  std::array<Entry, 8> node;       ///< from there bit 0 x, bit 1 y, bit 2 z; values of inner ones may be out of date

  /// The node that holds a key; nullptr: none of them does.
  template <KeyWord W>
  const Entry* node_of(const BasicKey<W>& key) const {
    const std::uint64_t x = (static_cast<std::uint64_t>(key.x) >> level) - lowest.x;
    const std::uint64_t y = (static_cast<std::uint64_t>(key.y) >> level) - lowest.y;
    const std::uint64_t z = (static_cast<std::uint64_t>(key.z) >> level) - lowest.z;
    return (x | y | z) < 2 ? &node[x | y << 1 | z << 2] : nullptr;
  }
};

/// The tree's nodes. Groups at depth 0..brick_depth-1, bricks below the entries of brick_depth. A lattice of one level
/// is kept in octant 0 of a single brick: its tree has one level more than the lattice (`extra_levels`).
struct BrickTree {
  explicit BrickTree(int lattice_depth)
      : levels(lattice_depth < 2 ? 2 : lattice_depth), extra_levels(levels - lattice_depth) {}
  BrickTree(const BrickTree&) = default;
  /// Throws std::bad_alloc, as copying does; then it is as it was.
  BrickTree& operator=(const BrickTree& other) { return *this = BrickTree(other); }
  /// Leaves an empty tree of the same levels behind.
  BrickTree(BrickTree&& other) noexcept
      : levels(other.levels),
        extra_levels(other.extra_levels),
        pruned(std::exchange(other.pruned, true)),
        early_drop(other.early_drop),
        root(std::exchange(other.root, {})),
        shortcut(std::exchange(other.shortcut, std::nullopt)),
        groups(std::move(other.groups)),
        bricks(std::move(other.bricks)) {}
  BrickTree& operator=(BrickTree&& other) noexcept {
    levels = other.levels;
    extra_levels = other.extra_levels;
    pruned = std::exchange(other.pruned, true);
    early_drop = other.early_drop;
    root = std::exchange(other.root, {});
    shortcut = std::exchange(other.shortcut, std::nullopt);
    groups = std::move(other.groups);
    bricks = std::move(other.bricks);
    return *this;
  }
  ~BrickTree() = default;

  int levels;
  int extra_levels;
  /// Whether equal siblings are joined everywhere. Not so after an editor with Pruning::kNever: then the octants of
  /// bricks are not to be read as joined either.
  bool pruned = true;
  EarlyDrop early_drop = EarlyDrop::kOn;
  Entry root;
  /// Always valid: dropped when a link at or above its nodes changes, and found again when their parents are updated.
  std::optional<Shortcut> shortcut;
  Pool<Group> groups;
  BrickPool bricks;

  int brick_depth() const { return levels - 2; }
  /// Of its nodes.
  std::size_t bytes() const { return groups.bytes() + bricks.bytes(); }
  /// Depth of the deepest node, brick_depth at most, that holds both keys.
  template <KeyWord W>
  int common_depth(const BasicKey<W>& a, const BasicKey<W>& b) const {
    const W difference = ((a.x ^ b.x) | (a.y ^ b.y) | (a.z ^ b.z)) >> 2;
    if (difference == 0) return brick_depth();
    const int depth = brick_depth() - 1 - highest_bit(difference);
    assert(depth >= 0);  // else a key lies outside of the lattice
    return depth;
  }
  /// Which child to take below a node of `depth` (in the tree's levels).
  template <KeyWord W>
  int octant_below(const BasicKey<W>& key, int depth) const {
    return key.octant(levels - 1 - depth);
  }
};

/// Value of a group (Parents). REQUIRES at least one known child.
float summary_of(const Group& group, Parents parents);
/// Value of a brick (Parents). REQUIRES a known cell.
float summary_of(BrickView brick, Parents parents);
/// All eight leaves, and equal.
bool is_uniform(const Group& group);
/// All cells known, and equal.
bool is_uniform(BrickView brick);
/// Evidence for the cells of one brick: `miss` where a bit of `missed` is set; where bit i of `hit` is set hits[i], or
/// `all_hits` when there are none. REQUIRES missed and hit to be disjoint.
struct CellUpdates {
  std::uint64_t missed = 0;
  LogOdds miss;
  std::uint64_t hit = 0;
  const float* hits = nullptr;
  LogOdds all_hits;
};
/// Adds evidence to a brick. @return whether anything changed
bool add(const CellUpdates& updates, const Clamp& clamp, BrickRef brick);

/// The evidence that each cell of a brick gets alike; nullopt: not all of them do.
std::optional<LogOdds> evidence_for_all(const CellUpdates& updates);

/// A brick that stands for an entry without one: of an unknown or a joined cell.
Brick brick_of(Entry entry);
/// The same for a group.
Group group_of(Entry entry);

/// For readers that build a tree from below: the entry for what they put together, which is stored unless that is
/// uniform, or nothing is known in it. Throws std::bad_alloc.
Entry store(BrickTree& tree, const Group& group, Parents parents);
/// The same for a brick whose cells are at their clamp. REQUIRES masks without a common bit.
Entry store(BrickTree& tree, const CellStates& cells, const Clamp& clamp, Parents parents);

/// The shortcut that leads farthest down, though not below pages. None where it would lead nowhere, nor in a tree of
/// more than 64 levels.
std::optional<Shortcut> shortcut_of(const BrickTree& tree);

/// New entry of a brick that changed: its link, or a leaf when it is uniform.
Entry synchronize_brick(BrickTree& tree, std::uint32_t index, Parents parents, Pruning pruning);
/// The same for a group whose children are up to date.
Entry synchronize_group(BrickTree& tree, std::uint32_t index, Parents parents, Pruning pruning);

/// Frees all that hangs below an entry of `depth`.
void release_below(BrickTree& tree, Entry entry, int depth);
/// Recomputes all inner nodes, and joins equal leaves everywhere. Sets `pruned`, and the shortcut.
void prune_all(BrickTree& tree, Parents parents);
/// Recomputes and returns `a` with the leaves of `b` (of another tree of the same levels) added, clamped.
Entry merge(BrickTree& tree, Entry a, const BrickTree& other, Entry b, int depth, Parents parents, const Clamp& clamp);

/// How a cursor changes a tree.
struct CursorRules {
  Parents parents = Parents::kMax;
  Pruning pruning = Pruning::kLazy;
  EarlyDrop early_drop = EarlyDrop::kOn;
  Clamp clamp{};
};

/// New entry at brick level for one without a brick (unknown, or a leaf). A brick is created only for a change that no
/// leaf can hold. Throws std::bad_alloc. REQUIRES !entry.is_inner(), and pruning
Entry update_without_brick(BrickTree& tree, const CursorRules& rules, const CellUpdates& updates, Entry entry);

}  // namespace detail

}  // namespace pingvox
