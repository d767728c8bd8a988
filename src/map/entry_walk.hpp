#pragma once

#include <algorithm>
#include <array>

#include "map/brick_tree.hpp"

namespace pingvox::detail {

/// Looks up cells of a const tree; it keeps the path from the root, so that a neighbour costs a step or two.
template <KeyWord W>
class EntryWalk {
 public:
  explicit EntryWalk(const BrickTree& tree) : tree_(tree) { entry_[0] = tree.root; }

  /// The deepest entry that holds a cell: a brick, a leaf, or nothing known.
  Entry to(const BasicKey<W>& key) {
    if (depth_ > 0) depth_ = std::min(depth_, tree_.common_depth(key_, key));
    key_ = key;
    Entry entry = entry_[static_cast<std::size_t>(depth_)];
    while (entry.is_inner() && depth_ < tree_.brick_depth()) {
      entry = tree_.groups[entry.link].child[static_cast<std::size_t>(tree_.octant_below(key, depth_))];
      entry_[static_cast<std::size_t>(++depth_)] = entry;
    }
    return entry;
  }

  /// Depth of that entry, in the tree's levels.
  int depth() const { return depth_; }

 private:
  const BrickTree& tree_;
  BasicKey<W> key_;
  int depth_ = 0;
  std::array<Entry, kLevelsOf<W>> entry_;  ///< of each depth on the way to key_
};

}  // namespace pingvox::detail
