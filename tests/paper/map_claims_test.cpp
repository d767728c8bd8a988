// Sections 5 and 7 of the paper: what it says of trees, keys and files.
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <random>
#include <sstream>

#include "bench/paper/bits.hpp"
#include "bench/paper/bytes.hpp"
#include "bench/paper/cube.hpp"
#include "bench/paper/parents.hpp"
#include "map/map_access.hpp"
#include "pingvox/analysis/compare.hpp"

namespace pingvox::bench {
namespace {

/// A field of a row by its name; nothing when it has no such field.
Value field(const Row& row, const std::string& name) {
  for (const auto& [key, value] : row.fields()) {
    if (key == name) return value;
  }
  return {};
}

Value ours_of(const std::vector<Row>& rows, const std::string& name) {
  for (const Row& row : rows) {
    if (field(row, "name") == Value(name)) return field(row, "ours");
  }
  ADD_FAILURE() << "no row " << name;
  return {};
}

void expect_checked(const std::vector<Row>& rows) {
  EXPECT_FALSE(rows.empty());
  for (const Row& row : rows) EXPECT_EQ(field(row, "checked"), Value(true)) << row.json().text();
}

TEST(PaperTable1, ItsLeavesAreAllNodesForOctomapToo) {
  octomap::OcTree tree(PaperCube::kCell_m);
  PaperCube{}.fill(tree, Pruning::kLazy);
  EXPECT_EQ(tree.size(), 19'769U) << "the paper: 19,769 leaves";
  EXPECT_EQ(tree.getNumLeafNodes(), 14'568U);
}

TEST(PaperTable1, EightUpdatesOfEachCellMakeTheSameTree) {
  const PaperCube once, eight{.evidence = LogOdds(20.0F), .updates_along_axis = 2};
  OccupancyMap map({.resolution_m = PaperCube::kCell_m});
  eight.fill(map, Pruning::kEachUpdate);
  EXPECT_EQ(map.counts().nodes(), 19'769U);
  EXPECT_EQ(map.counts().occupied_cells, 1'000'000U);
  EXPECT_EQ(map.root()->belief(), map.options().clamp.highest);
}

TEST(PaperBytes, ItsOnePointerANodeLeavesOutTheArraysPointedTo) {
  const auto rows = paper_bytes({});
  ASSERT_TRUE(rows);
  expect_checked(*rows);
  EXPECT_EQ(ours_of(*rows, "bytes-eight-pointers"), Value(std::uint64_t{19'769 * 64}));
  EXPECT_EQ(ours_of(*rows, "bytes-one-pointer"), Value(std::uint64_t{19'769 * 8}));
  EXPECT_EQ(ours_of(*rows, "bytes-with-arrays"), Value(std::uint64_t{19'769 * 8 + 5'201 * 64}));
}

TEST(PaperBits, OccupiedIsTwoAndFreeIsOneForOctomapToo) {
  const auto rows = paper_bits({});
  ASSERT_TRUE(rows);
  expect_checked(*rows);  // ours and liboctomap's files are the same bytes
  EXPECT_EQ(ours_of(*rows, "bt-unknown"), Value("00"));
  EXPECT_EQ(ours_of(*rows, "bt-occupied"), Value("10")) << "the paper: 01";
  EXPECT_EQ(ours_of(*rows, "bt-empty"), Value("01")) << "the paper: 10";
  EXPECT_EQ(ours_of(*rows, "bt-inner"), Value("11"));
}

TEST(PaperKeys, TheHighestBitPicksTheChildOfTheRoot) {
  for (const int bit : {0, 15}) {
    const auto x = static_cast<std::uint16_t>(1U << static_cast<unsigned>(bit));
    OccupancyMap map;
    {
      Editor editor = map.edit();
      editor.update(Key{x, 0, 0}, LogOdds(1.0F));
    }
    EXPECT_EQ(map.root()->child(1).has_value(), bit == 15);
    EXPECT_EQ(octomap::computeChildIdx(octomap::OcTreeKey(x, 0, 0), 15), bit == 15 ? 1 : 0);
  }
}

TEST(PaperDrop, UpdatesDroppedEarlyChangeNoMap) {
  OccupancyMap on, off;
  detail::MapAccess::set_early_drop(off, EarlyDrop::kOff);
  std::mt19937_64 random(8);
  {
    Editor with = on.edit(Pruning::kEachUpdate), without = off.edit(Pruning::kEachUpdate);
    for (int i = 0; i < 50'000; ++i) {
      const auto word = [&] { return static_cast<std::uint16_t>(32768 + random() % 12); };
      const Key key{word(), word(), word()};
      const LogOdds evidence(random() % 3 == 0 ? -0.4F : 1.386F);
      with.update(key, evidence);
      without.update(key, evidence);
    }
  }
  const auto compared = compare_maps(on, off, Sameness::kLogOdds);
  ASSERT_TRUE(compared);
  EXPECT_TRUE(compared->equal());
  EXPECT_EQ(on.counts().nodes(), off.counts().nodes());
  EXPECT_GT(compared->cells(), 1'500U);
}

TEST(PaperParents, APlannerThatSeesMeansDrivesThroughAPoleAndOneThatSeesMaximaDoesNot) {
  for (const Parents parents : {Parents::kMax, Parents::kMean}) {
    OccupancyMap map({.parents = parents});
    {
      Editor editor = map.edit();
      for (std::uint16_t x = 0; x < 32; ++x) {
        for (std::uint16_t y = 0; y < 16; ++y) {
          for (std::uint16_t z = 0; z < 16; ++z) {
            const bool is_pole = x == 5 && y == 5;
            editor.update(Key{x, y, z}, LogOdds(is_pole ? 3.0F : -1.0F));
          }
        }
      }
    }
    const CoarseView view = coarse_view(map, 12);
    EXPECT_EQ(view.blocks, 2U);
    EXPECT_EQ(view.with_obstacle, 1U);
    EXPECT_EQ(view.free_cells, 2U * 4096U - 16U);
    const bool is_max = parents == Parents::kMax;
    EXPECT_EQ(view.called_free, is_max ? 0U : 1U);
    EXPECT_EQ(view.called_occupied, is_max ? 1U : 0U);
    EXPECT_EQ(view.free_given_up, is_max ? 4096U - 16U : 0U);
    if (is_max) {
      EXPECT_NEAR(view.error, 4.0 * std::sqrt((4096.0 - 16.0) / 8192.0), 1e-9);
    } else {
      EXPECT_LT(view.error, 0.3);
    }
  }
}

}  // namespace
}  // namespace pingvox::bench
