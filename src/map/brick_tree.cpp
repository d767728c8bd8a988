#include "map/brick_tree.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "map/brick_loops.hpp"

namespace pingvox::detail {
namespace {

constexpr std::uint64_t kAllCells = ~std::uint64_t{0};

/// Belief of a cell after more evidence, as raw floats; `add_evidence` has the rule.
float add_evidence(float belief, LogOdds evidence, const Clamp& clamp) {
  return add_evidence(LogOdds(belief), evidence, clamp).value();
}

float clamp_to(float value, const Clamp& clamp) {
  return std::clamp(value, clamp.lowest.value(), clamp.highest.value());
}

Entry prune(BrickTree& tree, Entry entry, int depth, Parents parents) {
  if (!entry.is_inner()) return entry;
  if (depth == tree.brick_depth()) return synchronize_brick(tree, entry.link, parents, Pruning::kLazy);
  for (std::size_t o = 0; o < 8; ++o) {
    const Entry child = prune(tree, tree.groups[entry.link].child[o], depth + 1, parents);
    tree.groups[entry.link].child[o] = child;
  }
  // Only where memory ran out between making a group and making what it is for.
  const Group& group = tree.groups[entry.link];
  if (std::all_of(group.child.begin(), group.child.end(), [](const Entry& child) { return child.is_none(); })) {
    tree.groups.release(entry.link);
    return {};
  }
  return synchronize_group(tree, entry.link, parents, Pruning::kLazy);
}

/// Copies what hangs below an entry of another tree into this one, clamped.
Entry copy_from(BrickTree& tree, const BrickTree& other, Entry entry, int depth, Parents parents, const Clamp& clamp) {
  if (entry.is_none()) return entry;
  if (entry.is_leaf()) return Entry::leaf(clamp_to(entry.value, clamp));
  if (depth == tree.brick_depth()) {
    Brick brick = other.bricks[entry.link];
    for (std::size_t i = 0; i < 64; ++i) {
      if ((brick.known >> i) & 1) brick.value[i] = clamp_to(brick.value[i], clamp);
    }
    return synchronize_brick(tree, tree.bricks.allocate(brick), parents, Pruning::kLazy);
  }
  const std::uint32_t index = tree.groups.allocate({});
  for (std::size_t o = 0; o < 8; ++o) {
    const Entry child = copy_from(tree, other, other.groups[entry.link].child[o], depth + 1, parents, clamp);
    tree.groups[index].child[o] = child;
  }
  return synchronize_group(tree, index, parents, Pruning::kLazy);
}

Entry merge_brick(BrickTree& tree, Entry a, const BrickTree& other, Entry b, Parents parents, const Clamp& clamp) {
  const std::uint32_t index = a.is_inner() ? a.link : tree.bricks.allocate(brick_of(a));
  const BrickRef into = tree.bricks[index];
  const Brick from = b.is_leaf() ? brick_of(b) : Brick(other.bricks[b.link]);
  for (std::size_t i = 0; i < 64; ++i) {
    if (!((from.known >> i) & 1)) continue;
    const bool known = (into.known >> i) & 1;
    into.value[i] = known ? clamp_to(into.value[i] + from.value[i], clamp) : clamp_to(from.value[i], clamp);
  }
  into.known |= from.known;
  return synchronize_brick(tree, index, parents, Pruning::kLazy);
}

}  // namespace

Brick brick_of(Entry entry) {
  Brick brick;
  if (entry.is_leaf()) {
    brick.known = kAllCells;
    brick.value.fill(entry.value);
  }
  return brick;
}

std::optional<LogOdds> evidence_for_all(const CellUpdates& updates) {
  if (updates.missed == kAllCells) return updates.miss;
  if (updates.hit == kAllCells && updates.hits == nullptr) return updates.all_hits;
  return std::nullopt;
}

Group group_of(Entry entry) {
  Group group;
  if (entry.is_leaf()) group.child.fill(entry);
  return group;
}

Entry synchronize_brick(BrickTree& tree, std::uint32_t index, Parents parents, Pruning pruning) {
  const BrickView brick = tree.bricks[index];
  if (pruning != Pruning::kNever && is_uniform(brick)) {
    const Entry leaf = Entry::leaf(brick.value[0]);
    tree.bricks.release(index);
    return leaf;
  }
  return {index, summary_of(brick, parents)};
}

Entry synchronize_group(BrickTree& tree, std::uint32_t index, Parents parents, Pruning pruning) {
  const Group& group = tree.groups[index];
  if (pruning != Pruning::kNever && is_uniform(group)) {
    const Entry leaf = group.child[0];
    tree.groups.release(index);
    return leaf;
  }
  return {index, summary_of(group, parents)};
}

CellStates classify(BrickView brick, const Thresholds& thresholds) {
  const std::uint64_t occupied = brick.known & cells_from(brick, thresholds.upper.value());
  const std::uint64_t lower =
      thresholds.lower == thresholds.upper ? occupied : cells_from(brick, thresholds.lower.value());
  return {brick.known & ~lower & ~occupied, occupied};
}

Entry store(BrickTree& tree, const Group& group, Parents parents) {
  if (std::all_of(group.child.begin(), group.child.end(), [](const Entry& child) { return child.is_none(); })) {
    return {};
  }
  if (is_uniform(group)) return group.child[0];
  return {tree.groups.allocate(group), summary_of(group, parents)};
}

Entry store(BrickTree& tree, const CellStates& cells, const Clamp& clamp, Parents parents) {
  assert((cells.free & cells.occupied) == 0);
  const float lowest = clamp.lowest.value(), highest = clamp.highest.value();
  if (cells.free == kAllCells || cells.occupied == kAllCells) return Entry::leaf(cells.free != 0 ? lowest : highest);
  Brick brick;
  brick.known = cells.free | cells.occupied;
  if (brick.known == 0) return {};
  fill(brick, cells.free, lowest, cells.occupied, highest);
  const float most = cells.occupied != 0 ? highest : lowest;
  return {tree.bricks.allocate(brick), parents == Parents::kMax ? most : summary_of(brick, parents)};
}

bool add(const CellUpdates& updates, const Clamp& clamp, BrickRef brick) {
  assert((updates.missed & updates.hit) == 0);
  bool changed = false;
  const auto add_to = [&](std::uint64_t cells, LogOdds evidence) {
    if (cells == 0 || evidence == LogOdds(0.0F)) return;
    changed |= add_alike(brick, cells, evidence.value(), clamp);
    changed |= (cells & ~brick.known) != 0;
    brick.known |= cells;
  };
  add_to(updates.missed, updates.miss);
  if (updates.hits == nullptr) {
    add_to(updates.hit, updates.all_hits);
    return changed;
  }
  for (std::uint64_t left = updates.hit; left != 0; left &= left - 1) {
    const auto cell = static_cast<std::size_t>(std::countr_zero(left));
    const std::uint64_t bit = left & (~left + 1);
    const LogOdds evidence(updates.hits[cell]);
    if (evidence == LogOdds(0.0F)) continue;
    const float after = add_evidence(brick.value[cell], evidence, clamp);
    changed |= after != brick.value[cell] || (brick.known & bit) == 0;
    brick.value[cell] = after;
    brick.known |= bit;
  }
  return changed;
}

float summary_of(const Group& group, Parents parents) {
  float highest = std::numeric_limits<float>::lowest();
  double sum = 0.0;
  int known = 0;
  for (const Entry& child : group.child) {
    if (child.is_none()) continue;
    highest = std::max(highest, child.value);
    sum += double{child.value};
    ++known;
  }
  assert(known > 0);
  return parents == Parents::kMax ? highest : static_cast<float>(sum / known);
}

float summary_of_octant(BrickView brick, int octant, Parents parents) {
  const int mask = octant_known(brick, octant);
  assert(mask != 0);
  const float* const value = brick.value.data() + octant * 8;
  float highest = std::numeric_limits<float>::lowest();
  double sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    if (!((mask >> i) & 1)) continue;
    highest = std::max(highest, value[i]);
    sum += double{value[i]};
  }
  return parents == Parents::kMax ? highest : static_cast<float>(sum / std::popcount(static_cast<unsigned>(mask)));
}

float summary_of(BrickView brick, Parents parents) {
  assert(brick.known != 0);
  if (parents == Parents::kMax) return highest_of(brick);
  double sum = 0.0;
  int known = 0;
  for (int o = 0; o < 8; ++o) {
    if (octant_known(brick, o) == 0) continue;
    sum += double{summary_of_octant(brick, o, parents)};
    ++known;
  }
  return static_cast<float>(sum / known);
}

bool is_uniform(const Group& group) {
  return group.child[0].is_leaf() &&
         std::all_of(group.child.begin(), group.child.end(), [&](const Entry& c) { return c == group.child[0]; });
}

bool is_uniform(BrickView brick) {
  return brick.known == kAllCells && are_equal(brick);
}

std::uint64_t cells_of_uniform_octants(BrickView brick) {
  return cells_of_octants(full_bytes(brick.known) & ~octants_that_differ(brick));
}

void release_below(BrickTree& tree, Entry entry, int depth) {
  if (!entry.is_inner()) return;
  if (depth == tree.brick_depth()) {
    tree.bricks.release(entry.link);
    return;
  }
  for (const Entry& child : Group(tree.groups[entry.link]).child) release_below(tree, child, depth + 1);
  tree.groups.release(entry.link);
}

void prune_all(BrickTree& tree, Parents parents) {
  tree.root = prune(tree, tree.root, 0, parents);
  tree.pruned = true;
  tree.shortcut = shortcut_of(tree);
}

Entry merge(BrickTree& tree, Entry a, const BrickTree& other, Entry b, int depth, Parents parents, const Clamp& clamp) {
  if (b.is_none()) return a;
  if (a.is_none()) return copy_from(tree, other, b, depth, parents, clamp);
  if (a.is_leaf() && b.is_leaf()) return Entry::leaf(clamp_to(a.value + b.value, clamp));
  if (depth == tree.brick_depth()) return merge_brick(tree, a, other, b, parents, clamp);
  const std::uint32_t index = a.is_inner() ? a.link : tree.groups.allocate(group_of(a));
  for (std::size_t o = 0; o < 8; ++o) {
    const Entry from = b.is_leaf() ? b : other.groups[b.link].child[o];
    const Entry child = merge(tree, tree.groups[index].child[o], other, from, depth + 1, parents, clamp);
    tree.groups[index].child[o] = child;
  }
  return synchronize_group(tree, index, parents, Pruning::kLazy);
}

Entry update_without_brick(BrickTree& tree, const CursorRules& rules, const CellUpdates& updates, Entry entry) {
  assert(!entry.is_inner() && rules.pruning != Pruning::kNever);
  if (const auto evidence = evidence_for_all(updates)) {
    // The same for a whole leaf: the result is a leaf.
    return *evidence == LogOdds(0.0F) ? entry : Entry::leaf(add_evidence(entry.value, *evidence, rules.clamp));
  }
  Brick made = brick_of(entry);
  if (!add(updates, rules.clamp, made)) return entry;
  if (is_uniform(made)) return Entry::leaf(made.value[0]);
  return {tree.bricks.allocate(made), summary_of(made, rules.parents)};
}

}  // namespace pingvox::detail
