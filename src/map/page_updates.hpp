#pragma once

#include <cstddef>

#include "map/brick_tree.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox::detail {

/// Levels from a page of 4^3 bricks to its bricks.
inline constexpr int kPageLevels = 2;

/// The lowest cell of a brick of a page.
template <KeyWord W>
BasicKey<W> lowest_in(const ScanUpdate::Page& page, std::size_t brick) {
  const auto offset = [&](unsigned axis) {
    return static_cast<W>((((brick >> (3 + axis)) & 1) << 3) | (((brick >> axis) & 1) << 2));
  };
  const auto lowest = page.lowest.as<W>();
  return {lowest.x | offset(0), lowest.y | offset(1), lowest.z | offset(2)};
}

/// Updates of one brick of a page of a scan.
CellUpdates updates_of_brick(const ScanUpdate& scan, const ScanUpdate::Page& page, std::size_t brick);

/// Adds the updates of a page to a tree, from the page's node down, without keeping a path for each brick. No node is
/// created where nothing changes. Throws std::bad_alloc; then prune_all has to update the parents, and some of the
/// nodes created for this page may leak until the map is cleared.
/// @param entry  of the page's node; where that is part of a leaf, or of a node that nothing is known of, its entry
/// @return the new entry of the node, to be stored by the caller
/// REQUIRES brick_depth >= kPageLevels and pruning
Entry update_page(BrickTree& tree, const CursorRules& rules, const ScanUpdate& scan, const ScanUpdate::Page& page,
                  Entry entry);

}  // namespace pingvox::detail
