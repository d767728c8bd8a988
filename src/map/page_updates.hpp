#pragma once

#include <cstddef>

#include "map/brick_tree.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox::detail {

/// Levels from a page of 4^3 bricks to its bricks.
inline constexpr int kPageLevels = 2;

/// What a scan says of a brick of one of its pages.
CellUpdates updates_of_brick(const ScanUpdate& scan, const ScanUpdate::Page& page, std::size_t brick);

/// Adds what a scan says of a page to a tree: from the page's node down, without a path that is kept for each brick.
/// Nothing is made where nothing changes. Throws std::bad_alloc; parents are to be made right by prune_all then, and of
/// the few nodes made for this page some may be lost until the map is cleared.
/// @param entry  of the page's node; where that is part of a leaf, or of a node that nothing is known of, its entry
/// @return what the node is now, to be put there
/// REQUIRES brick_depth >= kPageLevels and pruning
Entry update_page(BrickTree& tree, const CursorRules& rules, const ScanUpdate& scan, const ScanUpdate::Page& page,
                  Entry entry);

}  // namespace pingvox::detail
