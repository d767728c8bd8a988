#include "map/page_updates.hpp"

#include <cassert>

#include "map/bits.hpp"

namespace pingvox::detail {
namespace {

/// The updates of one page. A node that changed gets its value once, when all of its children have theirs.
class PageUpdater {
 public:
  PageUpdater(BrickTree& tree, const CursorRules& rules, const ScanUpdate& scan, const ScanUpdate::Page& page)
      : tree_(tree),
        rules_(rules),
        scan_(scan),
        page_(page),
        // Only a maximum bounds the value of each cell.
        may_stay_(rules.early_drop == EarlyDrop::kOn && rules.parents == Parents::kMax && scan.miss() < LogOdds(0.0F)) {
  }

  /// New entry of the page.
  Entry page(Entry entry) {
    return children(entry, bytes_in_use(page_.bricks), [this](std::size_t o, Entry octant) {
      if (is_unchanged(octant, o)) return octant;
      return children(octant, page_.bricks >> (8 * o) & 0xFF,
                      [this, o](std::size_t i, Entry at) { return brick(at, 8 * o + i); });
    });
  }

 private:
  /// New entry of a node.
  /// @param which  of its children have updates: a bit each
  /// @param f      f(number, entry): new entry of one of them
  template <class F>
  Entry children(Entry entry, std::uint64_t which, F&& f) {
    bool changed = rules_.early_drop == EarlyDrop::kOff;
    if (!entry.is_inner()) {
      Group group = group_of(entry);
      for_each_bit(which, [&](std::size_t o) {
        const Entry now = f(o, group.child[o]);
        changed |= now != group.child[o];
        group.child[o] = now;
      });
      return changed ? store(tree_, group, rules_.parents) : entry;
    }
    for_each_bit(which, [&](std::size_t o) {
      // Groups may be elsewhere when f has made one.
      const Entry before = tree_.groups[entry.link].child[o], now = f(o, before);
      if (now == before) return;
      tree_.groups[entry.link].child[o] = now;
      changed = true;
    });
    return changed ? synchronize_group(tree_, entry.link, rules_.parents, rules_.pruning) : entry;
  }

  Entry brick(Entry entry, std::size_t number) {
    const CellUpdates updates = updates_of_brick(scan_, page_, number);
    if (!entry.is_inner()) return update_without_brick(tree_, rules_, updates, entry);
    const bool changed = add(updates, rules_.clamp, tree_.bricks[entry.link]) || rules_.early_drop == EarlyDrop::kOff;
    return changed ? synchronize_brick(tree_, entry.link, rules_.parents, rules_.pruning) : entry;
  }

  /// Whether an octant is unchanged because it has misses only and its known cells are at the lower clamp. That reads
  /// one word of each brick: after some scans from one place that is nearly all there is to do.
  bool is_unchanged(Entry octant, std::size_t o) const {
    const std::uint64_t hit = page_.bricks_hit >> (8 * o) & 0xFF;
    if (!may_stay_ || hit != 0 || LogOdds(octant.value) > rules_.clamp.lowest) return false;
    if (octant.is_leaf()) return true;
    if (octant.is_none()) return false;
    const Group& group = tree_.groups[octant.link];
    std::uint64_t unknown = 0;
    for_each_bit(page_.bricks >> (8 * o) & 0xFF, [&](std::size_t i) {
      const Entry& at = group.child[i];
      if (at.is_leaf()) return;
      unknown |= page_.missed[8 * o + i] & ~(at.is_inner() ? tree_.bricks[at.link].known : 0);
    });
    return unknown == 0;
  }

  BrickTree& tree_;
  const CursorRules& rules_;
  const ScanUpdate& scan_;
  const ScanUpdate::Page& page_;
  bool may_stay_;
};

}  // namespace

CellUpdates updates_of_brick(const ScanUpdate& scan, const ScanUpdate::Page& page, std::size_t brick) {
  if ((page.bricks_hit >> brick & 1) == 0) return {page.missed[brick], scan.miss(), 0, nullptr, {}};
  const std::uint64_t hit = page.hit[brick];
  const ScanUpdate::Hits hits = scan.hits(page, brick);
  return {page.missed[brick] & ~hit, scan.miss(), hit, hits.of_cell, hits.all};
}

Entry update_page(BrickTree& tree, const CursorRules& rules, const ScanUpdate& scan, const ScanUpdate::Page& page,
                  Entry entry) {
  assert(tree.brick_depth() >= kPageLevels && rules.pruning != Pruning::kNever);
  return PageUpdater(tree, rules, scan, page).page(entry);
}

}  // namespace pingvox::detail
