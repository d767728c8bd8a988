#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "pingvox/map/log_odds.hpp"

/// A map's tree, node by node (NodeView) or, for readers and writers of whole maps, brick by brick (TreeView and
/// TreeBuilder). A brick is 4 x 4 x 4 cells, the bottom two levels of the tree; above it are groups of eight children.
namespace pingvox {

class OccupancyMap;
struct MapOptions;

/// Value of an inner node (paper, section 5.3.1).
enum class Parents {
  kMax,   ///< the largest log-odds below it: a planner that reads inner nodes misses no obstacle
  kMean,  ///< the mean log-odds of the children that are known: the least error
};

/// When eight equal leaves become one.
enum class Pruning {
  kEachUpdate,  ///< at once, and parents are right after each update (paper: "w/ pruning")
  kLazy,        ///< parents and pruning wait for `synchronize` (paper: "lazy evaluation")
  kNever,       ///< parents wait for `synchronize`, nothing is joined (paper: "wo/ pruning")
};

namespace detail {

struct BrickTree;

/// A node above the bricks, as its parent holds it.
struct Entry {
  static constexpr std::uint32_t kNone = 0;  ///< nothing is known below; value is 0
  static constexpr std::uint32_t kLeaf = 1;  ///< value holds for the whole cell
  std::uint32_t link = kNone;                ///< else: index of its Group, or at brick level of its Brick
  /// Of an inner node: its value by Parents. At brick level, whenever a map can be read, a maximum is never
  /// less than the values below, also where an editor has not brought it up to date yet: writers rely on that.
  float value = 0.0F;

  static Entry leaf(float value) { return {kLeaf, value}; }
  bool is_none() const { return link == kNone; }
  bool is_leaf() const { return link == kLeaf; }
  bool is_inner() const { return link > kLeaf; }
  friend bool operator==(const Entry&, const Entry&) = default;
};

/// The eight children of an inner node, in one cache line. Child o is octant o (bit 0 x, bit 1 y, bit 2 z).
struct alignas(64) Group {
  std::array<Entry, 8> child;
};

/// Log-odds of the cells of a brick; 0 for unknown cells.
using CellValues = std::array<float, 64>;

/// The bottom two levels: 4 x 4 x 4 cells. Cell o * 8 + i is child i of octant o, so that each octant is a byte of the
/// mask.
struct Brick {
  std::uint64_t known = 0;
  CellValues value{};
};

/// A brick to be read, by itself or in a tree.
struct BrickView {
  BrickView(const Brick& brick) : known(brick.known), value(brick.value) {}
  BrickView(const std::uint64_t& known_cells, const CellValues& values) : known(known_cells), value(values) {}
  operator Brick() const { return {known, value}; }
  const std::uint64_t& known;
  const CellValues& value;
};

/// The storage of a map, to be read: valid as long as the map is not changed.
struct TreeView {
  struct Bricks {
    BrickView operator[](std::uint32_t link) const { return {known[link], value[link]}; }
    const std::uint64_t* known = nullptr;
    const CellValues* value = nullptr;
  };
  Entry root;
  const Group* groups = nullptr;                 ///< by the link of an inner entry above brick level
  Bricks bricks;                                 ///< by the link of an inner entry at brick level
  std::size_t group_count = 0, brick_count = 0;  ///< how many there may be at most
  int extra_levels = 0;  ///< that the tree has above those of the lattice: 1 in a lattice of one level, else 0
  bool pruned = true;    ///< whether eight equal cells are to be read as one leaf
};

/// The value of an octant of a brick by those of its cells. REQUIRES a known cell in it.
float summary_of_octant(BrickView brick, int octant, Parents parents);
/// The cells of those octants of which all cells are known, and equal.
std::uint64_t cells_of_uniform_octants(BrickView brick);

/// Occupied and free cells of a brick. Those in neither mask are unknown, or between the thresholds.
struct CellStates {
  std::uint64_t free = 0, occupied = 0;
};
CellStates classify(BrickView brick, const Thresholds& thresholds);

/// The tree of a map.
TreeView view_of(const OccupancyMap& map);

/// Builds the tree of a map from below.
class TreeBuilder {
 public:
  /// REQUIRES options that validate, and two levels at least.
  explicit TreeBuilder(const MapOptions& options);
  TreeBuilder(const TreeBuilder&) = delete;
  TreeBuilder& operator=(const TreeBuilder&) = delete;
  ~TreeBuilder();

  /// The entry for a brick whose cells are at their clamp. It is stored unless it is uniform, or nothing is known
  /// in it. Throws std::bad_alloc. REQUIRES masks without a common bit.
  Entry add(const CellStates& cells);
  /// The same for a group of what was added before.
  Entry add(const Group& group);
  /// Bytes of the tree so far.
  std::size_t bytes() const;
  /// The map with this root. To be called last.
  OccupancyMap finish(Entry root);

 private:
  std::unique_ptr<MapOptions> options_;
  std::unique_ptr<BrickTree> tree_;
};

}  // namespace detail

/// A node of a const map, to walk over: a small value, valid as long as the map is not changed.
class NodeView {
 public:
  /// Depth below the root of the lattice.
  int depth() const { return depth_ - extra_levels_; }
  /// Of an inner node: its value by Parents.
  LogOdds belief() const { return LogOdds(value_); }
  bool is_leaf() const { return kind_ == Kind::kLeaf; }
  /// Child in octant 0..7 (bit 0 x, bit 1 y, bit 2 z); nullopt: nothing is known there, or this is a leaf.
  std::optional<NodeView> child(int octant) const;

 private:
  friend class OccupancyMap;
  /// The node of an entry at `depth` of the tree's levels; nullopt when nothing is known there.
  static std::optional<NodeView> of(const detail::BrickTree& tree, detail::Entry entry, int depth, Parents parents);
  enum class Kind : std::uint8_t { kLeaf, kGroup, kBrick, kOctant };
  NodeView(const detail::BrickTree& tree, Kind kind, int depth, Parents parents, std::uint32_t index, float value);

  const detail::BrickTree* tree_;
  std::uint32_t index_;  ///< of the group or brick
  float value_;
  int depth_;  ///< in the tree's levels
  Kind kind_;
  Parents parents_;
  std::uint8_t extra_levels_;  ///< that the tree has above the lattice's
  std::uint8_t octant_ = 0;    ///< kOctant: which of the brick's
};

}  // namespace pingvox
