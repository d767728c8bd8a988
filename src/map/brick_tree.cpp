#include "map/brick_tree.hpp"

#include <algorithm>
#include <limits>

#include "map/brick_loops.hpp"

namespace pingvox {
namespace detail {
namespace {

constexpr std::uint64_t kAllCells = ~std::uint64_t{0};

/// Belief of a cell after more evidence, as raw floats; `add_evidence` has the rule.
float add_evidence(float belief, LogOdds evidence, const Clamp& clamp) {
  return add_evidence(LogOdds(belief), evidence, clamp).value();
}

float clamp_to(float value, const Clamp& clamp) {
  return std::clamp(value, clamp.lowest.value(), clamp.highest.value());
}

/// Index of the highest bit that is set. REQUIRES that one is.
int highest_bit(std::uint64_t word) {
  return 63 - std::countl_zero(word);
}
int highest_bit(WideWord word) {
  const auto high = static_cast<std::uint64_t>(word >> 64);
  return high != 0 ? 64 + highest_bit(high) : highest_bit(static_cast<std::uint64_t>(word));
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

template <KeyWord W>
int BrickTree::common_depth(const BasicKey<W>& a, const BasicKey<W>& b) const {
  const W difference = ((a.x ^ b.x) | (a.y ^ b.y) | (a.z ^ b.z)) >> 2;
  if (difference == 0) return brick_depth();
  const int depth = brick_depth() - 1 - highest_bit(difference);
  assert(depth >= 0);  // else a key lies outside of the lattice
  return depth;
}
template int BrickTree::common_depth(const BasicKey<std::uint64_t>&, const BasicKey<std::uint64_t>&) const;
template int BrickTree::common_depth(const BasicKey<WideWord>&, const BasicKey<WideWord>&) const;

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

// ---------------------------------------------------------------------------------------------------------------------

template <KeyWord W>
Cursor<W>::Cursor(BrickTree& tree, const CursorRules& rules) : tree_(tree), rules_(rules) {}

template <KeyWord W>
Entry& Cursor<W>::entry_at(int depth) {
  if (depth == 0) return tree_.root;
  const auto above = static_cast<std::size_t>(depth - 1);
  return tree_.groups[group_[above]].child[static_cast<std::size_t>(octant_at(depth - 1))];
}

template <KeyWord W>
void Cursor<W>::move_to(const BasicKey<W>& key, int depth) {
  if (is_placed_) {
    if ((((key_.x ^ key.x) | (key_.y ^ key.y) | (key_.z ^ key.z)) >> 2) == 0) {
      key_ = key;
      return;
    }
    const int common = tree_.common_depth(key_, key);
    if (common < reach_) {
      // The group below the shared node stays on the path, and with it the knowledge whether it is stale.
      synchronize_up_to(common + 1);
      reach_ = common + 1;
    }
  }
  is_placed_ = true;
  key_ = key;
  Entry entry = entry_at(reach_);
  while (reach_ < depth && entry.is_inner()) {
    const auto at = static_cast<std::size_t>(reach_);
    group_[at] = entry.link;
    stale_[at] = false;
    ++reach_;
    entry = tree_.groups[entry.link].child[static_cast<std::size_t>(octant_at(reach_ - 1))];
  }
  brick_ = reach_ == tree_.brick_depth() && entry.is_inner() ? entry.link : Entry::kNone;
}

template <KeyWord W>
void Cursor<W>::grow_to(int depth) {
  while (reach_ < depth) {
    const std::uint32_t index = tree_.groups.allocate(group_of(entry_at(reach_)));
    entry_at(reach_).link = index;
    drop_shortcut_at(reach_);
    mark_stale_above(reach_);
    const auto at = static_cast<std::size_t>(reach_);
    group_[at] = index;
    stale_[at] = true;
    ++reach_;
  }
}

template <KeyWord W>
BrickRef Cursor<W>::make_brick() {
  if (brick_ == Entry::kNone) {
    grow_to(tree_.brick_depth());
    Entry& entry = entry_at(tree_.brick_depth());
    brick_ = tree_.bricks.allocate(brick_of(entry));
    entry.link = brick_;
    mark_stale_above(reach_);
  }
  return tree_.bricks[brick_];
}

template <KeyWord W>
void Cursor<W>::synchronize_brick() {
  if (!brick_stale_) return;
  brick_stale_ = false;
  Entry& entry = entry_at(tree_.brick_depth());
  Entry now = entry;
  if (rules_.pruning != Pruning::kNever && is_uniform(tree_.bricks[entry.link])) {
    now = Entry::leaf(tree_.bricks[entry.link].value[0]);
    tree_.bricks.release(entry.link);
    brick_ = Entry::kNone;
  } else if (brick_summary_ == Summary::kStale) {
    now.value = summary_of(tree_.bricks[entry.link], rules_.parents);
  }
  brick_summary_ = Summary::kRight;
  if (now == entry && rules_.early_drop == EarlyDrop::kOn) return;
  entry = now;
  mark_stale_above(reach_);
}

template <KeyWord W>
void Cursor<W>::synchronize_group(int depth) {
  const auto at = static_cast<std::size_t>(depth);
  if (!stale_[at]) return;
  stale_[at] = false;
  Entry& entry = entry_at(depth);
  const Entry now = detail::synchronize_group(tree_, entry.link, rules_.parents, rules_.pruning);
  if (now.is_leaf()) {
    reach_ = depth;
    drop_shortcut_at(depth);
  }
  if (now == entry && rules_.early_drop == EarlyDrop::kOn) return;
  entry = now;
  mark_stale_above(depth);
}

// Updates all entries of the path from its end up to `depth`; the path is kept as far as its nodes still exist.
template <KeyWord W>
void Cursor<W>::synchronize_up_to(int depth) {
  if (reach_ == tree_.brick_depth()) synchronize_brick();
  for (int d = reach_ - 1; d >= std::max(depth, 0); --d) {
    // If all parents are updated after each update, the ancestors of a valid node are valid.
    if (rules_.pruning == Pruning::kEachUpdate && !stale_[static_cast<std::size_t>(d)]) break;
    synchronize_group(d);
  }
}

template <KeyWord W>
void Cursor<W>::mark_stale_above(int depth) {
  if (depth > 0) stale_[static_cast<std::size_t>(depth - 1)] = true;
}

// For an entry whose link changed: the shortcut may point to the old node.
template <KeyWord W>
void Cursor<W>::drop_shortcut_at(int depth) {
  if (tree_.shortcut && tree_.levels - depth >= tree_.shortcut->level) tree_.shortcut.reset();
}

template <KeyWord W>
void Cursor<W>::finish_change(int depth) {
  mark_stale_above(depth);
  if (rules_.pruning == Pruning::kEachUpdate) synchronize_up_to(0);
}

template <KeyWord W>
void Cursor<W>::leave_brick() {
  brick_ = Entry::kNone;
  brick_stale_ = false;
  brick_summary_ = Summary::kRight;
}

template <KeyWord W>
void Cursor<W>::mark_brick_stale() {
  brick_stale_ = true;
  brick_summary_ = Summary::kStale;
  if (rules_.pruning == Pruning::kEachUpdate) synchronize_up_to(0);
}

// For a cell of the brick that is now as large. Also where the brick is stale: see Entry::value.
template <KeyWord W>
void Cursor<W>::raise_maximum(float value) {
  Entry& at_brick = entry_at(tree_.brick_depth());
  if (rules_.parents != Parents::kMax || value <= at_brick.value) return;
  at_brick.value = value;
  mark_stale_above(reach_);
}

template <KeyWord W>
void Cursor<W>::flush() {
  synchronize_up_to(0);
  reach_ = 0;
  is_placed_ = false;
  if (!tree_.shortcut) tree_.shortcut = shortcut_of(tree_);
}

template <KeyWord W>
void Cursor<W>::update(const BasicKey<W>& key, LogOdds evidence) {
  move_to(key);
  const auto cell = static_cast<std::size_t>(cell_in_brick(key));
  const std::uint64_t bit = std::uint64_t{1} << cell;
  const bool in_brick = brick_ != Entry::kNone;
  const Entry end = in_brick ? Entry{} : entry_at(reach_);
  const bool known = in_brick ? (tree_.bricks[brick_].known & bit) != 0 : end.is_leaf();
  const float before = in_brick ? tree_.bricks[brick_].value[cell] : end.value;
  const float after = add_evidence(before, evidence, rules_.clamp);
  // An update without effect is dropped before any node is created or marked. Evidence of 0 makes no cell known.
  const bool changes = known ? after != before : evidence != LogOdds(0.0F);
  if (!changes && (rules_.early_drop == EarlyDrop::kOn || !in_brick || !known)) return;
  const BrickRef brick = make_brick();
  const bool is_first = brick.known == 0;
  brick.known |= bit;
  brick.value[cell] = after;
  brick_stale_ = true;
  // A maximum that grows, or loses none of its cells, needs no look at the other cells.
  const bool keeps_maximum = rules_.parents == Parents::kMax && !is_first &&
                             (!known || after >= before || before < entry_at(tree_.brick_depth()).value);
  if (!keeps_maximum) brick_summary_ = Summary::kStale;
  raise_maximum(after);
  if (rules_.pruning == Pruning::kEachUpdate) synchronize_up_to(0);
}

template <KeyWord W>
bool Cursor<W>::update_brick(const BasicKey<W>& key, const CellUpdates& updates) {
  move_to(key);
  const Entry entry = entry_at(reach_);
  if (entry.is_inner()) {
    const bool changed = add(updates, rules_.clamp, tree_.bricks[entry.link]);
    if (changed || rules_.early_drop == EarlyDrop::kOff) mark_brick_stale();
    return changed;
  }
  const Entry now = update_without_brick(tree_, rules_, updates, entry);
  if (now == entry) return false;
  grow_to(tree_.brick_depth());
  entry_at(tree_.brick_depth()) = now;
  brick_ = now.is_inner() ? now.link : Entry::kNone;
  finish_change(reach_);
  return true;
}

template <KeyWord W>
void Cursor<W>::set(const BasicKey<W>& key, int depth, float value) {
  move_to(key);
  const int at = std::min(depth, tree_.brick_depth());
  if (reach_ > at) {
    // The nodes below are discarded, so there is nothing to synchronize.
    reach_ = at;
    leave_brick();
  }
  grow_to(at);
  Entry& entry = entry_at(at);
  if (depth <= tree_.brick_depth()) {
    release_below(tree_, entry, at);
    entry = Entry::leaf(value);
    drop_shortcut_at(at);
    leave_brick();
    finish_change(at);
    return;
  }
  const BrickRef brick = make_brick();
  const bool whole_octant = depth == tree_.levels - 1;
  const int first = whole_octant ? key.octant(1) * 8 : cell_in_brick(key);
  const int count = whole_octant ? 8 : 1;
  brick.known |= whole_octant ? octant_mask(key.octant(1)) : std::uint64_t{1} << first;
  std::fill_n(brick.value.begin() + first, count, value);
  raise_maximum(value);
  mark_brick_stale();
}

template <KeyWord W>
typename Cursor<W>::Reach Cursor<W>::reach(const BasicKey<W>& key) {
  move_to(key);
  return {reach_, entry_at(reach_)};
}

template <KeyWord W>
Entry Cursor<W>::seek(const BasicKey<W>& key, int depth) {
  assert(reach_ <= depth);
  move_to(key, depth);
  return entry_at(reach_);
}

template <KeyWord W>
void Cursor<W>::put(int depth, Entry entry) {
  grow_to(depth);
  Entry& before = entry_at(depth);
  // The shortcut holds the values of leaves, too.
  if (!entry.is_inner() || entry.link != before.link) drop_shortcut_at(depth);
  before = entry;
  mark_stale_above(depth);
}

template class Cursor<std::uint64_t>;
template class Cursor<WideWord>;

}  // namespace detail
}  // namespace pingvox
