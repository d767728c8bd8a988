#include <gtest/gtest.h>

#include <random>

#include "map/map_access.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "support/differences.hpp"
#include "support/oracle_map.hpp"

using namespace pingvox;
using test::first_difference;
using test::Node;
using test::nodes_of;
using test::OracleMap;

namespace {

TEST(Editor, ThatNeverPrunesKeepsEachCellALeaf) {
  std::size_t leaves = 0;
  for (const Parents parents : {Parents::kMax, Parents::kMean}) {
    for (const int depth : {1, 2, 3, 8, 16, 128}) {
      SCOPED_TRACE(depth);
      std::mt19937_64 random(1);
      OccupancyMap map({.depth = depth, .parents = parents});
      OracleMap oracle(depth, map.options().clamp);
      for (int round = 0; round < 3; ++round) {
        Editor editor = map.edit(Pruning::kNever);
        for (int i = 0; i < 3'000; ++i) {
          const auto word = [&] { return WideWord{random() % 8} & test::highest_word(depth); };
          const WideKey key{word(), word(), word()};
          editor.update(key, LogOdds(3.0F));
          oracle.update(key, LogOdds(3.0F));
        }
        editor.synchronize();
        const std::vector<Node> expected = oracle.nodes(parents, OracleMap::Join::kNothing);
        ASSERT_EQ(first_difference(nodes_of(map), expected), "");
      }
      leaves += map.counts().leaves;
      // The next scan, even an empty one, joins them again.
      ASSERT_TRUE(map.apply(ScanUpdate(map.lattice())));
      ASSERT_EQ(first_difference(nodes_of(map), oracle.nodes(parents, OracleMap::Join::kEqualLeaves)), "");
    }
  }
  EXPECT_GT(leaves, 4'000U);
}

TEST(Editor, GivesEqualMapsForKeysOfEveryWidth) {
  const auto map_of = [&]<KeyWord W>() {
    OccupancyMap map({.depth = 8});
    std::mt19937_64 random(5);
    Editor editor = map.edit(Pruning::kEachUpdate);
    for (int i = 0; i < 5'000; ++i) {
      const auto word = [&] { return static_cast<W>(120 + random() % 16); };
      const BasicKey<W> key{word(), word(), word()};
      editor.update(key, LogOdds(random() % 4 == 0 ? -4.0F : 4.0F));
      if (i % 100 == 0) editor.set(key, 6, LogOdds(1.0F));
      EXPECT_TRUE(map.at(key));
    }
    return map;
  };
  const std::vector<Node> expected = nodes_of(map_of.operator()<std::uint8_t>());
  EXPECT_GT(expected.size(), 1'000U);
  EXPECT_EQ(first_difference(nodes_of(map_of.operator()<std::uint16_t>()), expected), "");
  EXPECT_EQ(first_difference(nodes_of(map_of.operator()<std::uint32_t>()), expected), "");
  EXPECT_EQ(first_difference(nodes_of(map_of.operator()<std::uint64_t>()), expected), "");
  EXPECT_EQ(first_difference(nodes_of(map_of.operator()<WideWord>()), expected), "");
}

// A brick that was left without being the last of its group must still reach its parents.
TEST(Editor, ParentsSeeAChangeBeforeTheCursorMovedOnToASibling) {
  OccupancyMap map;
  {
    Editor editor = map.edit();
    editor.update(Key{0, 0, 0}, LogOdds(-1.0F));
    editor.update(Key{4, 0, 0}, LogOdds(-1.0F));
    editor.synchronize();
    editor.update(Key{0, 0, 0}, LogOdds(3.0F));
    editor.update(Key{4, 0, 0}, LogOdds(-0.5F));
  }
  EXPECT_EQ(map.root()->belief(), LogOdds(2.0F));
}

TEST(Editor, SettingACellReplacesAllThatWasInIt) {
  for (const Pruning pruning : {Pruning::kEachUpdate, Pruning::kLazy, Pruning::kNever}) {
    OccupancyMap map({.depth = 20});
    std::mt19937_64 random(2);
    {
      Editor editor = map.edit(pruning);
      for (int i = 0; i < 2'000; ++i) {
        const auto word = [&] { return static_cast<std::uint32_t>(random() % (1U << 20)); };
        editor.update(BasicKey<std::uint32_t>{word(), word(), word()}, LogOdds(1.0F));
      }
    }
    const std::size_t before = map.memory_bytes();
    {
      Editor editor = map.edit(pruning);
      editor.update(BasicKey<std::uint32_t>{5, 5, 5}, LogOdds(1.0F));  // its brick is open and stale
      editor.set(BasicKey<std::uint32_t>{5, 5, 5}, 0, LogOdds(-2.0F));
    }
    const MapCounts counts = map.counts();
    EXPECT_EQ(counts.leaves, 1U);
    EXPECT_EQ(counts.inner, 0U);
    EXPECT_EQ(counts.free_cells, std::uint64_t{1} << 60);
    EXPECT_EQ(map.at(BasicKey<std::uint32_t>{77, 1, 9}), LogOdds(-2.0F));
    // What was freed is used again.
    {
      Editor editor = map.edit(pruning);
      for (std::uint32_t i = 0; i < 1'000; ++i) {
        editor.update(BasicKey<std::uint32_t>{i * 1000, i * 7, i}, LogOdds(1.0F));
      }
    }
    EXPECT_LE(map.memory_bytes(), before + 100'000);
  }
}

TEST(Editor, AnUpdateThatCannotChangeACellMakesNothing) {
  for (const EarlyDrop early_drop : {EarlyDrop::kOn, EarlyDrop::kOff}) {
    OccupancyMap map;
    detail::MapAccess::set_early_drop(map, early_drop);
    {
      Editor editor = map.edit();
      editor.set(Key{0, 0, 0}, 3, LogOdds(map.options().clamp.highest));
    }
    const std::size_t bytes = map.memory_bytes();
    const auto before = nodes_of(map);
    {
      Editor editor = map.edit(Pruning::kEachUpdate);
      editor.update(Key{1, 2, 3}, LogOdds(0.85F));
      editor.update(Key{1, 2, 3}, LogOdds(0.0F));
      editor.update(Key{60000, 2, 3}, LogOdds(0.0F));
      editor.update(Key{60000, 2, 3}, LogOdds(-0.0F));
    }
    ScanUpdate scan(map.lattice(), LogOdds(0.0F));
    scan.add_miss(Key{50000, 0, 0});
    scan.add_hit(Key{50001, 0, 0}, LogOdds(0.0F));
    scan.add_hit(Key{1, 1, 1}, LogOdds(2.0F));
    ASSERT_TRUE(map.apply(scan));
    EXPECT_EQ(map.memory_bytes(), bytes);
    EXPECT_EQ(first_difference(nodes_of(map), before), "");
    EXPECT_FALSE(map.at(Key{50000, 0, 0}));
  }
}

TEST(OccupancyMap, ValuesOutsideOfTheClampAreKeptUntilEvidenceMovesThem) {
  OccupancyMap map;
  Editor editor = map.edit();
  editor.set(Key{1, 1, 1}, 16, LogOdds(20.0F));
  editor.update(Key{1, 1, 1}, LogOdds(1.0F));
  EXPECT_EQ(map.at(Key{1, 1, 1}), LogOdds(20.0F));
  editor.update(Key{1, 1, 1}, LogOdds(-1.0F));
  EXPECT_EQ(map.at(Key{1, 1, 1}), map.options().clamp.highest);
}

TEST(OccupancyMap, MapsOfTwoLatticesLiveSideBySide) {
  OccupancyMap coarse({.resolution_m = 1.0, .depth = 8}), fine({.resolution_m = 0.01, .depth = 40});
  const Eigen::Vector3d point_m(1.25, -3.0, 0.5);
  {
    Editor one = coarse.edit(), two = fine.edit();
    one.update(*coarse.lattice().key_of<std::uint8_t>(point_m), LogOdds(1.0F));
    two.update(*fine.lattice().key_of<std::uint64_t>(point_m), LogOdds(-1.0F));
  }
  EXPECT_EQ(coarse.at(point_m), LogOdds(1.0F));
  EXPECT_EQ(fine.at(point_m), LogOdds(-1.0F));
  EXPECT_EQ(coarse.at({1.9, -2.1, 0.0}), LogOdds(1.0F));
  EXPECT_FALSE(fine.at({1.9, -2.1, 0.0}));
  EXPECT_FALSE(coarse.at({128.0, 0.0, 0.0}));
  const auto merged = coarse.merge(fine);
  ASSERT_FALSE(merged);
  EXPECT_EQ(merged.error().code, Error::Code::kBadOption);
}

TEST(OccupancyMap, CountsOfHugeCellsStayAtTheirMost) {
  OccupancyMap map({.depth = 128});
  {
    Editor editor = map.edit();
    editor.set(WideKey{}, 1, LogOdds(-1.0F));
    editor.set(WideKey{~WideWord{0}, 0, 0}, 1, LogOdds(-1.0F));
    editor.set(WideKey{~WideWord{0}, ~WideWord{0}, 0}, 107, LogOdds(1.0F));
  }
  const MapCounts counts = map.counts();
  EXPECT_EQ(counts.free_cells, ~std::uint64_t{0});
  EXPECT_EQ(counts.occupied_cells, std::uint64_t{1} << 63);
}

TEST(OccupancyMap, NamesEveryBrokenOption) {
  MapOptions options;
  options.depth = 129;
  options.clamp.lowest = LogOdds(0.5F);
  options.thresholds = {LogOdds(1.0F), LogOdds(0.0F)};
  const auto map = OccupancyMap::make(options);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, Error::Code::kBadOption);
  for (const char* word : {"129", "clamp", "threshold"}) {
    EXPECT_NE(map.error().message.find(word), std::string::npos) << map.error().message;
  }
  EXPECT_TRUE(OccupancyMap::make({}));
}

// Kills a leaf that is told at its corner instead of its middle, or a joined one as small as a cell.
TEST(ForEachLeaf, GivesCubesInMetresWithoutKeys) {
  for (const int depth : {8, 16, 40, 100}) {
    SCOPED_TRACE(depth);
    OccupancyMap map({.resolution_m = 0.1, .depth = depth});
    ScanUpdate scan(map.lattice());
    for (const double x : {0.05, 0.15}) {
      for (const double y : {0.05, 0.15}) {
        for (const double z : {0.05, 0.15}) scan.add_miss(*map.lattice().key_of<WideWord>({x, y, z}));
      }
    }
    scan.add_hit(*map.lattice().key_of<WideWord>({-0.25, 0.35, 0.45}), LogOdds(0.85F));
    ASSERT_TRUE(map.apply(scan));
    std::size_t free = 0, occupied = 0;
    for_each_leaf(map, [&](const Leaf& leaf) {
      const bool is_free = leaf.belief < LogOdds(0.0F);
      EXPECT_NEAR(
          (leaf.centre_m() - (is_free ? Eigen::Vector3d(0.1, 0.1, 0.1) : Eigen::Vector3d(-0.25, 0.35, 0.45))).norm(),
          0.0, 1e-9);
      EXPECT_NEAR(leaf.edge_m(), is_free ? 0.2 : 0.1, 1e-12);
      (is_free ? free : occupied) += 1;
    });
    EXPECT_EQ(free, 1U);
    EXPECT_EQ(occupied, 1U);
    std::size_t boxed = 0;
    for_each_leaf(map, {.max_depth = {}, .box = Box{{-1.0, -1.0, -1.0}, {0.0, 1.0, 1.0}}},
                  [&](const Leaf& leaf) { boxed += leaf.belief > LogOdds(0.0F) ? 1 : 2; });
    EXPECT_EQ(boxed, 1U);
  }
}

// Kills a scan that is applied to a map of other cells unseen.
TEST(ScanUpdate, IsRefusedByMapsOfOtherLattices) {
  const ScanUpdate scan(Lattice(0.05));
  for (const MapOptions& options : {MapOptions{.resolution_m = 0.1}, MapOptions{.resolution_m = 0.05, .depth = 20}}) {
    OccupancyMap map(options);
    const auto applied = map.apply(scan);
    ASSERT_FALSE(applied);
    EXPECT_EQ(applied.error().code, Error::Code::kBadOption);
  }
}

TEST(ScanUpdate, AHitBeatsAMissAndTheStrongestHitCounts) {
  ScanUpdate scan{Lattice(MapOptions::kDefaultResolution_m)};
  const Key cell{100, 200, 300};
  for (int round = 0; round < 2; ++round) {
    scan.add_hit(cell, LogOdds(0.3F));
    scan.add_miss(cell);
    scan.add_hit(cell, LogOdds(1.1F));
    scan.add_hit(cell, LogOdds(0.7F));
    OccupancyMap map;
    const auto report = map.apply(scan);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->cells_hit, 1U);
    EXPECT_EQ(report->cells_freed, 0U);
    EXPECT_EQ(map.at(cell), LogOdds(1.1F));
    // Used again, it remembers nothing of the scan before.
    scan.clear();
    EXPECT_TRUE(scan.empty());
    scan.add_miss(cell);
    OccupancyMap freed;
    ASSERT_TRUE(freed.apply(scan));
    EXPECT_EQ(freed.at(cell), scan.miss());
    scan.clear();
  }
}

// Kills a brick of 4 x 4 x 4 cells, all of them hit, that gets the evidence of one of them.
TEST(ScanUpdate, EachCellOfAFullBrickHasItsOwnEvidence) {
  ScanUpdate scan{Lattice(MapOptions::kDefaultResolution_m)};
  const auto cell = [](int n) {
    return Key{static_cast<std::uint16_t>(4 + n % 4), static_cast<std::uint16_t>(8 + n / 4 % 4),
               static_cast<std::uint16_t>(12 + n / 16)};
  };
  const auto evidence = [](int n) { return LogOdds(0.3F + 0.01F * static_cast<float>(n)); };
  for (int n = 0; n < 64; ++n) scan.add_hit(cell(n), evidence(n));
  OccupancyMap map;
  ASSERT_TRUE(map.apply(scan));
  for (int n = 0; n < 64; ++n) EXPECT_EQ(map.at(cell(n)), evidence(n)) << n;
}

}  // namespace
