// Maps judged by ground truth, on worlds drawn by hand: '#' occupied, '.' free, ' ' unknown; a cell is 1 m wide, the
// first row has the lowest y.
#include "pingvox/analysis/map_agreement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace pingvox {
namespace {

using Drawing = std::vector<std::string>;

OccupancyMap draw(const Drawing& rows) {
  OccupancyMap map(MapOptions{.resolution_m = 1.0});
  Editor editor = map.edit();
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      if (rows[y][x] == ' ') continue;
      const auto key = map.lattice().key_of({static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, 0.5});
      editor.set(*key, map.lattice().depth(), LogOdds(rows[y][x] == '#' ? 2.0F : -2.0F));
    }
  }
  editor.synchronize();
  return map;
}

const Drawing kWall = {"......",  //
                       "......",  //
                       "......",  //
                       "######"};

MapAgreement judged(const Drawing& map) {
  return agreement_of(draw(map), draw(kWall));
}

TEST(MapAgreement, OfTheTruthItselfIsPerfect) {
  const MapAgreement score = judged(kWall);
  EXPECT_EQ(score.precision(), 1.0);
  EXPECT_EQ(score.recall(), 1.0);
  EXPECT_EQ(score.free_true(), 1.0);
  EXPECT_EQ(score.free_true_near(), 1.0);
  EXPECT_EQ(score.occupied_a, 6U);
  EXPECT_EQ(score.free_a, 18U);
}

// Kills a large leaf that counts as fewer cells than it holds.
TEST(MapAgreement, CountsTheCellsOfLargeLeaves) {
  OccupancyMap map(MapOptions{.resolution_m = 1.0});
  const int depth = map.lattice().depth();
  map.edit().set(*map.lattice().key_of({0.5, 0.5, 0.5}), depth - 2, LogOdds(-2.0F));
  map.edit().set(*map.lattice().key_of({8.5, 0.5, 0.5}), depth - 1, LogOdds(2.0F));
  const MapAgreement score = agreement_of(map, map);
  EXPECT_EQ(score.free_a, 64U);
  EXPECT_EQ(score.free_both, 64U);
  EXPECT_EQ(score.occupied_b, 8U);
  EXPECT_EQ(score.precision(), 1.0);
  EXPECT_EQ(score.recall(), 1.0);
}

TEST(MapAgreement, ForgivesAWallOneCellOffAndNotTwo) {
  const MapAgreement one = judged({"......", "......", "######"});
  EXPECT_EQ(one.precision(), 1.0);
  EXPECT_EQ(one.recall(), 1.0);
  const MapAgreement two = judged({"......", "######"});
  EXPECT_EQ(two.precision(), 0.0);
  EXPECT_EQ(two.recall(), 0.0);
}

// Kills a distance that is always one cell, is counted along the axes only, or wraps at the border of the lattice.
TEST(MapAgreement, ForgivesAsManyCellsAsItIsTold) {
  const OccupancyMap wall = draw(kWall), two_off = draw({"......", "######"}), three_off = draw({"######"});
  const AgreementOptions two{.box = {}, .visible = nullptr, .near_cells = 2};
  EXPECT_EQ(agreement_of(two_off, wall, two).precision(), 1.0);
  EXPECT_EQ(agreement_of(two_off, wall, two).recall(), 1.0);
  EXPECT_EQ(agreement_of(three_off, wall, two).precision(), 0.0);
  EXPECT_EQ(agreement_of(three_off, wall, two).recall(), 0.0);

  OccupancyMap first(MapOptions{.resolution_m = 1.0, .depth = 4}), last(first);
  first.edit().set(Key{0, 0, 0}, 4, LogOdds(2.0F));
  last.edit().set(Key{15, 15, 15}, 4, LogOdds(2.0F));
  EXPECT_EQ(agreement_of(first, last, two).precision(), 0.0);
  EXPECT_EQ(agreement_of(last, first, {.box = {}, .visible = nullptr, .near_cells = 15}).precision(), 1.0);
}

// The oracle looks at all pairs of cells of a small lattice. Kills cells that are near beyond its border.
TEST(MapAgreement, CountsWhatAllPairsOfCellsSay) {
  constexpr int kDepth = 3, kSide = 1 << kDepth;
  using Cells = std::vector<std::pair<std::array<int, 3>, char>>;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto make = [&](Cells& cells) {
      OccupancyMap map(MapOptions{.resolution_m = 1.0, .depth = kDepth});
      for (int i = 0; i < kSide * kSide * kSide; ++i) {
        const std::array<int, 3> at = {i % kSide, i / kSide % kSide, i / kSide / kSide};
        const std::uint64_t drawn = random() % 100;
        if (drawn >= 8) continue;
        cells.emplace_back(at, drawn < 4 ? '#' : '.');
        const auto word = [&](std::size_t axis) { return static_cast<std::uint16_t>(at[axis]); };
        map.edit().set(Key{word(0), word(1), word(2)}, kDepth, LogOdds(drawn < 4 ? 2.0F : -2.0F));
      }
      return map;
    };
    Cells a, b;
    const OccupancyMap map_a = make(a), map_b = make(b);
    for (const int reach : {0, 1, 2, 7}) {
      const auto near = [&](const Cells& of, const Cells& to, char kind) {
        std::uint64_t count = 0;
        for (const auto& [at, is] : of) {
          const auto is_near = [&, from = at](const auto& other) {
            int apart = 0;
            for (std::size_t axis = 0; axis < 3; ++axis)
              apart = std::max(apart, std::abs(other.first[axis] - from[axis]));
            return other.second == kind && apart <= reach;
          };
          if (is == kind && std::ranges::any_of(to, is_near)) ++count;
        }
        return count;
      };
      const MapAgreement found =
          agreement_of(map_a, map_b, {.box = {}, .visible = nullptr, .near_cells = static_cast<std::uint32_t>(reach)});
      EXPECT_EQ(found.a_near_b, near(a, b, '#')) << reach;
      EXPECT_EQ(found.found_by_a, near(b, a, '#')) << reach;
      EXPECT_EQ(found.free_near, near(a, b, '.')) << reach;
    }
  }
}

TEST(MapAgreement, AWallThatIsNotThereLowersPrecisionOnly) {
  const MapAgreement score = judged({"######", "......", "......", "######"});
  EXPECT_EQ(score.precision(), 0.5);
  EXPECT_EQ(score.recall(), 1.0);
}

TEST(MapAgreement, HalfAWallLowersRecallOnly) {
  const MapAgreement score = judged({"......", "......", "......", "###   "});
  EXPECT_EQ(score.precision(), 1.0);
  EXPECT_EQ(score.recall(), 4.0 / 6.0);  // the fourth cell touches the third
}

TEST(MapAgreement, WhatCouldNotBeSeenIsNotMissed) {
  const OccupancyMap visible = draw({"      ", "      ", "      ", "###   "});
  const MapAgreement score =
      agreement_of(draw({"......", "......", "......", "###   "}), draw(kWall), {.box = {}, .visible = &visible});
  EXPECT_EQ(score.recall(), 1.0);
  EXPECT_EQ(score.to_find, 3U);
  EXPECT_EQ(score.precision(), 1.0);
}

TEST(MapAgreement, CellsFreedBehindAWallAreWrongEvenWithinOneCell) {
  // One cell of the wall is freed, and two behind it.
  const MapAgreement score = judged({"......", "......", "......", "###.##", "   .  ", "   .  "});
  EXPECT_EQ(score.free_a, 21U);
  EXPECT_EQ(score.free_both, 18U);
  EXPECT_EQ(score.free_true(), 18.0 / 21.0);
  EXPECT_EQ(score.free_near, 19U);  // the wall's own touches water
}

TEST(MapAgreement, CountsOnlyCellsWithTheirMiddleInTheBox) {
  // A leaf of 8 x 8 x 8 cells, of which the box cuts 3 x 8 x 1 out.
  OccupancyMap map(MapOptions{.resolution_m = 1.0});
  map.edit().set(*map.lattice().key_of({0.5, 0.5, 0.5}), map.lattice().depth() - 3, LogOdds(-2.0F));
  const AgreementOptions options{.box = Box{{0.6, -100.0, 0.4}, {3.6, 1e30, 1.4}}, .visible = nullptr};
  EXPECT_EQ(agreement_of(map, map, options).free_both, 3U * 8U);
  const AgreementOptions nowhere{.box = Box{{0.6, 0.0, 0.0}, {1.4, 9.0, 9.0}}, .visible = nullptr};
  EXPECT_EQ(agreement_of(map, map, nowhere).free_a, 0U);
}

TEST(JudgedBox, EndsWhereTheTruthHasNoWallAndGoesOnBehindOne) {
  const auto box = judged_box(draw({"......#",  //
                                    "......#",  //
                                    "#######"}),
                              3.0);
  ASSERT_TRUE(box);
  EXPECT_EQ(box->min, Eigen::Vector3d(0.0, 0.0, 0.0));
  EXPECT_EQ(box->max, Eigen::Vector3d(10.0, 6.0, 1.0));
}

TEST(JudgedBox, IsNotOpenedByAWallThatRisesAboveTheWater) {
  OccupancyMap truth = draw({"......#", "......#", "#######"});
  truth.edit().set(*truth.lattice().key_of({6.5, 0.5, 1.5}), truth.lattice().depth(), LogOdds(2.0F));
  EXPECT_EQ(judged_box(truth)->max.z(), 1.0);
}

TEST(JudgedBox, OfNothingIsNothing) {
  EXPECT_FALSE(judged_box(OccupancyMap(MapOptions{.resolution_m = 1.0})));
}

}  // namespace
}  // namespace pingvox
