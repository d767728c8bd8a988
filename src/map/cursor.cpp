#include "map/cursor.hpp"

#include <algorithm>
#include <cassert>

namespace pingvox::detail {

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
  const float after = add_evidence(LogOdds(before), evidence, rules_.clamp).value();
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

}  // namespace pingvox::detail
