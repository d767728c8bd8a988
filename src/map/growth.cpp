#include "map/growth.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "map/bits.hpp"
#include "map/cursor.hpp"
#include "map/page_updates.hpp"

namespace pingvox::detail {
namespace {

/// Counts the nodes that updates would make, brick by brick.
template <KeyWord W>
class Growth {
 public:
  Growth(BrickTree& tree, const Clamp& clamp) : tree_(tree), clamp_(clamp), cursor_(tree, {}) {}

  enum class More { kNo, kYes };
  /// @param more  whether updates on the same brick follow
  void add(const BasicKey<W>& key, const CellUpdates& updates, More more) {
    const auto reach = cursor_.reach(key);
    if (reach.end.is_inner()) return;
    Brick brick = brick_of(reach.end);
    if (!detail::add(updates, clamp_, brick)) return;
    if (more == More::kYes || !is_uniform(brick)) ++bricks_;
    // Groups that the brick made before needs are counted already.
    const int from = std::max(reach.depth, made_ ? tree_.common_depth(*made_, key) + 1 : 0);
    if (from < tree_.brick_depth()) groups_ += static_cast<std::size_t>(tree_.brick_depth() - from);
    made_ = key;
  }

  std::size_t bytes() const {
    const auto beyond = [](std::size_t wanted, std::size_t spare) { return wanted > spare ? wanted - spare : 0; };
    return beyond(bricks_, tree_.bricks.spare()) * sizeof(Brick) +
           beyond(groups_, tree_.groups.spare()) * sizeof(Group);
  }

 private:
  BrickTree& tree_;
  Clamp clamp_;
  Cursor<W> cursor_;
  std::size_t bricks_ = 0, groups_ = 0;
  std::optional<BasicKey<W>> made_;
};

}  // namespace

template <KeyWord W>
std::size_t growth_of(BrickTree& tree, const ScanUpdate& scan, const Clamp& clamp) {
  Growth<W> growth(tree, clamp);
  for (const std::uint32_t index : scan.pages_in_order()) {
    const ScanUpdate::Page& page = scan.page(index);
    for_each_bit(page.bricks, [&](std::size_t brick) {
      growth.add(lowest_in<W>(page, brick), updates_of_brick(scan, page, brick), Growth<W>::More::kNo);
    });
  }
  return growth.bytes();
}
template std::size_t growth_of<std::uint64_t>(BrickTree&, const ScanUpdate&, const Clamp&);
template std::size_t growth_of<WideWord>(BrickTree&, const ScanUpdate&, const Clamp&);

std::size_t growth_of(BrickTree& tree, KeyBatch& batch, LogOdds evidence, const Clamp& clamp) {
  using Growing = Growth<std::uint64_t>;
  Growing growth(tree, clamp);
  batch.take([&](const BasicKey<std::uint64_t>& key, const KeyBatch::Cells& cells) {
    growth.add(key, {0, {}, cells.once, nullptr, evidence}, cells.more != 0 ? Growing::More::kYes : Growing::More::kNo);
  });
  return growth.bytes();
}

}  // namespace pingvox::detail
