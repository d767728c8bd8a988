#pragma once

#include <array>
#include <cstdint>

#include "map/brick_tree.hpp"
#include "pingvox/geometry/key.hpp"
#include "pingvox/map/log_odds.hpp"

namespace pingvox::detail {

/// A position in a tree and the path to it. All changes go through it, except below pages (`update_page`,
/// map/page_updates.hpp). Moving synchronizes the nodes that it leaves, so keys in the tree's order (or near it) cost a
/// few steps each, and every parent is recomputed once. Two widths are compiled: 64 bits, and wide for deeper lattices.
template <KeyWord W>
class Cursor {
 public:
  Cursor(BrickTree& tree, const CursorRules& rules);

  /// Adds evidence to one cell.
  void update(const BasicKey<W>& key, LogOdds evidence);

  /// Adds evidence to the cells of the brick that holds `key`. Throws std::bad_alloc: a brick that was made for it may
  /// then be lost until the map is cleared. @return whether anything changed. REQUIRES pruning
  bool update_brick(const BasicKey<W>& key, const CellUpdates& updates);

  /// Makes the whole node of `depth` (in the tree's levels) that holds `key` a leaf.
  void set(const BasicKey<W>& key, int depth, float value);

  /// Synchronizes the path up to the root and leaves it.
  void flush();

  /// Where the path to the brick of `key` ends: used to foresee growth. Moves there.
  struct Reach {
    int depth;  ///< of the deepest entry
    Entry end;  ///< inner: the brick is there
  };
  Reach reach(const BasicKey<W>& key);
  /// The entry of the node of `depth` that holds `key`, or of the leaf (or what is not known) that this is part of.
  /// Moves there; what hangs below may be changed before the next move. REQUIRES that the cursor was nowhere deeper.
  Entry seek(const BasicKey<W>& key, int depth);
  /// Stores the new entry of the node that was sought last.
  void put(int depth, Entry entry);

 private:
  void move_to(const BasicKey<W>& key) { move_to(key, tree_.brick_depth()); }
  /// To a node of `depth` at most.
  void move_to(const BasicKey<W>& key, int depth);
  Entry& entry_at(int depth);
  int octant_at(int depth) const { return tree_.octant_below(key_, depth); }
  void grow_to(int depth);
  BrickRef make_brick();
  void mark_stale_above(int depth);
  void drop_shortcut_at(int depth);
  void synchronize_brick();
  void synchronize_group(int depth);
  void synchronize_up_to(int depth);
  void finish_change(int depth);
  void mark_brick_stale();
  void raise_maximum(float value);
  void leave_brick();

  BrickTree& tree_;
  CursorRules rules_;
  BasicKey<W> key_;
  bool is_placed_ = false;              ///< whether the path leads to key_
  int reach_ = 0;                       ///< depth of the deepest entry on the path
  std::uint32_t brick_ = Entry::kNone;  ///< the brick at its end, if there is one
  bool brick_stale_ = false;
  /// Whether the brick's entry holds its maximum although the brick is stale.
  enum class Summary : std::uint8_t { kRight, kStale } brick_summary_ = Summary::kRight;
  // Group n holds the children of the path's node of depth n; it is stale when one of them changed.
  std::array<std::uint32_t, kLevelsOf<W>> group_{};
  std::array<bool, kLevelsOf<W>> stale_{};
};

}  // namespace pingvox::detail
