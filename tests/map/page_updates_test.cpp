#include "map/page_updates.hpp"

#include <gtest/gtest.h>

namespace pingvox::detail {
namespace {

constexpr LogOdds kMiss{-0.4F};
const CursorRules kRules{.clamp = {LogOdds(-2.0F), LogOdds(3.5F)}};

/// Misses in `missed` of a brick of the page at 0, hits that say `hit` in the others.
ScanUpdate scan_of_brick(std::size_t brick, std::uint64_t missed, LogOdds hit) {
  ScanUpdate scan(Lattice(1.0), kMiss);
  const std::uint32_t page = scan.page_of({0, 0, 0});
  scan.mark_missed_in(page, brick, missed);
  if (~missed != 0) scan.mark_hit_in(page, brick, ~missed, hit);
  return scan;
}

Entry update_once(BrickTree& tree, const ScanUpdate& scan, Entry entry) {
  return update_page(tree, kRules, scan, scan.page(0), entry);
}

TEST(PageUpdates, HitsThatSayWhatMissesSayMakeALeaf) {
  BrickTree tree(16);
  const Entry page = update_once(tree, scan_of_brick(13, ~std::uint64_t{1}, kMiss), {});
  ASSERT_TRUE(page.is_inner());
  const Entry octant = tree.groups[page.link].child[1];
  ASSERT_TRUE(octant.is_inner());
  EXPECT_EQ(tree.groups[octant.link].child[5], Entry::leaf(-0.4F));
  EXPECT_EQ(tree.bricks.bytes(), 0U);
}

TEST(PageUpdates, WhatChangesNothingMakesNothing) {
  BrickTree tree(16);
  // Part of a larger node that is as free as can be already, beyond that, or of what evidence of nothing says nothing.
  for (const float value : {-2.0F, -9.0F}) {
    const Entry leaf = Entry::leaf(value);
    EXPECT_EQ(update_once(tree, scan_of_brick(13, 0xF0F0, kMiss), leaf), leaf);
    EXPECT_EQ(update_once(tree, scan_of_brick(63, ~std::uint64_t{0}, kMiss), leaf), leaf);
  }
  ScanUpdate nothing(Lattice(1.0), LogOdds(0.0F));
  nothing.mark_missed_in(nothing.page_of({0, 0, 0}), 5, 0xFF);
  EXPECT_EQ(update_once(tree, nothing, {}), Entry{});
  EXPECT_EQ(tree.groups.bytes() + tree.bricks.bytes(), 0U);
}

TEST(PageUpdates, OneCellOfALeafMakesOneBrick) {
  BrickTree tree(16);
  const Entry page = update_once(tree, scan_of_brick(63, ~std::uint64_t{1}, LogOdds(0.85F)), Entry::leaf(-1.0F));
  ASSERT_TRUE(page.is_inner());
  EXPECT_EQ(page.value, -1.0F + 0.85F);
  EXPECT_EQ(tree.groups.bytes(), 2 * sizeof(Group));
  EXPECT_EQ(tree.bricks.bytes(), sizeof(Brick));
  const Group& bricks = tree.groups[tree.groups[page.link].child[7].link];
  EXPECT_EQ(bricks.child[6], Entry::leaf(-1.0F));
  const BrickView brick = tree.bricks[bricks.child[7].link];
  EXPECT_EQ(brick.value[0], -1.0F + 0.85F);
  EXPECT_EQ(brick.value[1], -1.0F - 0.4F);
  EXPECT_EQ(bricks.child[7].value, brick.value[0]);
}

}  // namespace
}  // namespace pingvox::detail
