#include "pingvox/analysis/cut_tree.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pingvox/analysis/compare.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

/// Cells and larger leaves at random near the middle.
OccupancyMap random_map(const MapOptions& options, unsigned seed) {
  std::mt19937 random(seed);
  OccupancyMap map(options);
  Editor editor = map.edit();
  const WideWord middle = WideWord{1} << (options.depth - 1);
  const auto word = [&] { return middle + random() % 32 - 16; };
  for (int i = 0; i < 300; ++i) {
    const LogOdds belief(static_cast<float>(random() % 7) - 3.0F);
    editor.set(WideKey{word(), word(), word()}, options.depth - static_cast<int>(random() % 3), belief);
  }
  editor.synchronize();
  return map;
}

TEST(CutTree, SaysOfEachCellWhatItsAncestorAtThatDepthSaid) {
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE(kSeed);
  for (const int levels : {5, 16, 40, 100}) {
    for (const Parents parents : {Parents::kMax, Parents::kMean}) {
      const OccupancyMap map = random_map({.resolution_m = 0.1, .depth = levels, .parents = parents}, kSeed);
      for (const int depth : {levels - 4, levels - 3, levels - 2, levels - 1}) {
        const OccupancyMap cut = cut_tree(map, depth);
        std::size_t cells = 0;
        for_each_leaf(map, [&](const Leaf& leaf) {
          ++cells;
          ASSERT_EQ(cut.at(leaf.key), map.node_at(leaf.key, depth)->belief()) << levels << " levels, cut at " << depth;
        });
        EXPECT_GT(cells, 100U);
        for_each_leaf(cut, [&](const Leaf& leaf) {
          ASSERT_LE(leaf.depth, depth);
          ASSERT_TRUE(map.node_at(leaf.key, depth)) << "nothing was known there";
        });
      }
    }
  }
}

TEST(CutTree, FromTheLastLevelOnIsACopy) {
  const OccupancyMap map = random_map({.resolution_m = 0.1}, 6);
  for (const int depth : {16, 17, 200}) {
    const Result<MapComparison> comparison = compare_maps(map, cut_tree(map, depth), Sameness::kLogOdds);
    ASSERT_TRUE(comparison);
    EXPECT_GT(comparison->same, 0U);
    EXPECT_TRUE(comparison->equal());
  }
}

TEST(CutTree, KeepsThresholdsAndNothing) {
  const Thresholds thresholds{LogOdds(-0.5F), LogOdds(0.75F)};
  const OccupancyMap cut = cut_tree(OccupancyMap({.resolution_m = 0.3, .depth = 1, .thresholds = thresholds}), 1);
  EXPECT_TRUE(cut.empty());
  EXPECT_EQ(cut.options().thresholds.upper, thresholds.upper);
  EXPECT_EQ(cut.options().thresholds.lower, thresholds.lower);
  EXPECT_EQ(cut.lattice().resolution_m(), 0.3);
}

}  // namespace
}  // namespace pingvox
