// What judges maps, on worlds drawn by hand: '#' occupied, '.' free, ' ' unknown.
#include "accuracy/map_score.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "accuracy/cell_grid.hpp"

namespace pingvox::bench {
namespace {

CellGrid grid_of(const std::vector<std::string>& rows) {
  CellGrid grid({static_cast<std::int64_t>(rows.front().size()), static_cast<std::int64_t>(rows.size()), 1});
  grid.for_each([&](const CellGrid::Cell& c) {
    const char drawn = rows[static_cast<std::size_t>(c[1])][static_cast<std::size_t>(c[0])];
    grid.at(c) = drawn == '#' ? Occupancy::kOccupied : drawn == '.' ? Occupancy::kFree : Occupancy::kUnknown;
  });
  return grid;
}

const std::vector<std::string> kWall = {"......",  //
                                        "......",  //
                                        "......",  //
                                        "######",  //
                                        "      ",  //
                                        "      "};
/// The surfaces alone.
const std::vector<std::string> kSeen = {"      ",  //
                                        "      ",  //
                                        "      ",  //
                                        "######",  //
                                        "      ",  //
                                        "      "};

TEST(MapScore, OfTheTruthItselfIsPerfect) {
  const MapScore score = score_map(grid_of(kWall), grid_of(kWall), grid_of(kSeen));
  EXPECT_EQ(score.precision(), 1.0);
  EXPECT_EQ(score.recall(), 1.0);
  EXPECT_EQ(score.free_share(), 1.0);
  EXPECT_EQ(score.occupied, 6U);
  EXPECT_EQ(score.free, 18U);
}

TEST(MapScore, ForgivesAWallOneCellOffAndNotTwo) {
  const MapScore one =
      score_map(grid_of({"......", "......", "######", "      ", "      ", "      "}), grid_of(kWall), grid_of(kSeen));
  EXPECT_EQ(one.precision(), 1.0);
  EXPECT_EQ(one.recall(), 1.0);
  const MapScore two =
      score_map(grid_of({"......", "######", "      ", "      ", "      ", "      "}), grid_of(kWall), grid_of(kSeen));
  EXPECT_EQ(two.precision(), 0.0);
  EXPECT_EQ(two.recall(), 0.0);
}

TEST(MapScore, AWallThatIsNotThereLowersPrecisionOnly) {
  const MapScore score =
      score_map(grid_of({"######", "......", "......", "######", "      ", "      "}), grid_of(kWall), grid_of(kSeen));
  EXPECT_EQ(score.precision(), 0.5);
  EXPECT_EQ(score.recall(), 1.0);
}

TEST(MapScore, HalfAWallLowersRecallOnly) {
  const MapScore score =
      score_map(grid_of({"......", "......", "......", "###   ", "      ", "      "}), grid_of(kWall), grid_of(kSeen));
  EXPECT_EQ(score.precision(), 1.0);
  EXPECT_EQ(score.recall(), 4.0 / 6.0);  // the fourth cell touches the third
}

TEST(MapScore, WhatCouldNotBeSeenIsNotMissed) {
  const MapScore score =
      score_map(grid_of({"......", "......", "......", "###   ", "      ", "      "}), grid_of(kWall),
                grid_of({"      ", "      ", "      ", "###   ", "      ", "      "}));
  EXPECT_EQ(score.recall(), 1.0);
}

TEST(MapScore, CellsFreedBehindAWallAreWrongEvenWithinOneCell) {
  // One cell of the wall is freed, and two behind it.
  const MapScore score =
      score_map(grid_of({"......", "......", "......", "###.##", "   .  ", "   .  "}), grid_of(kWall), grid_of(kSeen));
  EXPECT_EQ(score.free, 21U);
  EXPECT_EQ(score.free_right, 18U);
  EXPECT_EQ(score.free_near, 19U);  // the wall's own touches water
}

}  // namespace
}  // namespace pingvox::bench
