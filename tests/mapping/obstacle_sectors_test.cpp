#include "mapping/internal/obstacle_sectors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

using What = ObstacleSectors::What;

OccupancyMap empty_map() {
  Result<OccupancyMap> map = OccupancyMap::make({.resolution_m = 0.1});
  EXPECT_TRUE(map);
  return *std::move(map);
}

void set(OccupancyMap& map, const Eigen::Vector3d& place_m, float belief) {
  Editor editor = map.edit();
  editor.set(*map.lattice().key_of(place_m), map.lattice().depth(), LogOdds(belief));
}

/// A place at a range and an angle clockwise from the vehicle's ahead.
Eigen::Vector3d around(const Pose& pose, double range_m, double clockwise_deg, double up_m = 0.0) {
  const double angle_rad = -clockwise_deg * kDegree_rad;
  return pose * Eigen::Vector3d(range_m * std::cos(angle_rad), range_m * std::sin(angle_rad), up_m);
}

// Kills sectors that go round the other way, begin elsewhere, or turn with the map instead of the vehicle.
TEST(ObstacleSectors, GoClockwiseFromAheadOfTheVehicle) {
  const Pose pose = pose_from_rpy({3.0, -7.0, 1.0}, 0.0, 0.0, 2.1);
  for (const std::size_t sector : {0U, 1U, 18U, 36U, 54U, 71U}) {
    SCOPED_TRACE(sector);
    OccupancyMap map = empty_map();
    set(map, around(pose, 6.0, 5.0 * static_cast<double>(sector)), 2.0F);
    const ObstacleSectors found = nearest_obstacles(map, pose, {});
    for (std::size_t i = 0; i < found.sectors.size(); ++i) {
      EXPECT_EQ(found.sectors[i].what, i == sector ? What::kObstacle : What::kUnknown) << i;
    }
    EXPECT_NEAR(found.sectors[sector].range_m, 6.0, 0.1);
  }
}

TEST(ObstacleSectors, TheNearestCellCountsInEachSectorThatItReachesInto) {
  OccupancyMap map = empty_map();
  const Pose pose = pose_from_rpy({0.05, 0.05, 0.05}, 0.0, 0.0, 0.0);  // in the middle of a cell
  set(map, around(pose, 4.0, 90.0), 2.0F);
  set(map, around(pose, 2.0, 90.0), 2.0F);
  set(map, around(pose, 3.0, 90.0), 2.0F);
  set(map, around(pose, 0.5, 180.0), 2.0F);  // 8 degrees to either side
  const ObstacleSectors found = nearest_obstacles(map, pose, {});
  EXPECT_NEAR(found.sectors[18].range_m, 2.0, 0.1);
  for (const std::size_t i : {35U, 36U, 37U}) EXPECT_EQ(found.sectors[i].what, What::kObstacle) << i;
  for (const std::size_t i : {33U, 39U, 0U}) EXPECT_EQ(found.sectors[i].what, What::kUnknown) << i;
}

// Kills the middle of a pruned leaf that is taken for its nearest cell.
TEST(ObstacleSectors, APrunedLeafIsAsNearAsItsCells) {
  for (const Eigen::Vector3d& here :
       {Eigen::Vector3d(0.0, 0.8, 0.8), Eigen::Vector3d(2.1, 0.4, 0.1), Eigen::Vector3d(1.7, 4.9, 1.0)}) {
    OccupancyMap pruned = empty_map(), whole = empty_map();
    const int levels = pruned.lattice().depth();
    {
      // 1.6 m to a side: 16 cells.
      Editor one = pruned.edit(), each = whole.edit();
      one.set(*pruned.lattice().key_of({1.65, 0.05, 0.05}), levels - 4, LogOdds(2.0F));
      for (double x = 1.65; x < 3.2; x += 0.1) {
        for (double y = 0.05; y < 1.6; y += 0.1) {
          for (double z = 0.05; z < 1.6; z += 0.1) {
            // Alternating beliefs are not pruned.
            const auto key = whole.lattice().key_of({x, y, z});
            each.set(*key, levels, LogOdds((key->x + key->y + key->z) % 2 == 0 ? 2.0F : 1.5F));
          }
        }
      }
    }
    const Pose pose = pose_from_rpy(here, 0.0, 0.0, 0.3);
    for (const double reach_m : {10.0, 2.2}) {
      const ObstacleSectors a = nearest_obstacles(pruned, pose, {.max_range_m = reach_m}),
                            b = nearest_obstacles(whole, pose, {.max_range_m = reach_m});
      for (std::size_t i = 0; i < a.sectors.size(); ++i) {
        EXPECT_EQ(a.sectors[i].what, b.sectors[i].what) << i;
        EXPECT_NEAR(a.sectors[i].range_m, b.sectors[i].range_m, 1e-9) << i;
      }
    }
  }
}

TEST(ObstacleSectors, LeaveOutTheVehicleItselfAndWhatIsAboveBelowOrFarAway) {
  OccupancyMap map = empty_map();
  const Pose pose = pose_from_rpy({0.0, 0.0, -5.0}, 0.3, 0.2, 0.0);
  const auto place = [](double x, double z) { return Eigen::Vector3d(x, 0.05, z); };
  set(map, place(0.12, -4.95), 2.0F);  // the vehicle
  set(map, place(3.0, -4.2), 2.0F);    // above
  set(map, place(3.0, -5.8), 2.0F);    // below
  set(map, place(10.6, -4.95), 2.0F);  // far away
  set(map, place(5.0, -4.95), -1.0F);  // free
  EXPECT_EQ(nearest_obstacles(map, pose, {}).sectors[0].what, What::kUnknown);
  set(map, place(7.0, -5.35), 2.0F);
  const ObstacleSectors found = nearest_obstacles(map, pose, {});
  EXPECT_EQ(found.sectors[0].what, What::kObstacle) << "roll and pitch move nothing";
  EXPECT_NEAR(found.sectors[0].range_m, 7.0, 0.1);
}

TEST(ObstacleSectors, AreClearOnlyWhereAllIsFreeUpToTheRange) {
  OccupancyMap map = empty_map();
  for (double x = 0.85; x < 10.2; x += 0.1) {
    set(map, {x, 0.05, 0.05}, -1.0F);
    if (x < 9.0) set(map, {0.05, x, 0.05}, -1.0F);
  }
  const Pose pose = pose_from_rpy({0.05, 0.05, 0.05}, 0.0, 0.0, 0.0);
  const ObstacleSectors found = nearest_obstacles(map, pose, {});
  EXPECT_EQ(found.sectors[0].what, What::kClear);
  EXPECT_EQ(found.sectors[54].what, What::kUnknown) << "left: free up to 9 m";
  EXPECT_EQ(found.sectors[36].what, What::kUnknown);
}

/// Sectors of a kind.
std::vector<std::size_t> sectors_that_are(What what, const ObstacleSectors& found) {
  std::vector<std::size_t> sectors;
  for (std::size_t i = 0; i < found.sectors.size(); ++i) {
    if (found.sectors[i].what == what) sectors.push_back(i);
  }
  return sectors;
}

// Kills sectors that are said to be clear on the wrong side of the vehicle, or of the map.
TEST(ObstacleSectors, AreClearOnTheSideWhereAllIsFree) {
  for (const double yaw_rad : {0.0, 0.4, 1.7, 3.0, -2.2, -0.9}) {
    SCOPED_TRACE(yaw_rad);
    const Pose pose = pose_from_rpy({3.04, -7.03, 1.02}, 0.0, 0.0, yaw_rad);
    OccupancyMap map = empty_map();
    // Free from 5 to 80 degrees and from 215 to 225 degrees, an obstacle at 300: nothing is alike left and right.
    for (double clockwise_deg = 0.0; clockwise_deg < 230.0; clockwise_deg += 0.25) {
      if (clockwise_deg > 85.0 && clockwise_deg < 210.0) continue;
      for (double range_m = 0.5; range_m < 5.3; range_m += 0.03) {
        set(map, around(pose, range_m, clockwise_deg), -1.0F);
      }
    }
    set(map, around(pose, 4.5, 300.0), 2.0F);
    const ObstacleSectors found = nearest_obstacles(map, pose, {.max_range_m = 5.0});
    std::vector<std::size_t> expected;
    for (std::size_t i = 1; i <= 16; ++i) expected.push_back(i);
    for (std::size_t i = 43; i <= 45; ++i) expected.push_back(i);
    std::vector<std::size_t> clear = sectors_that_are(What::kClear, found);
    // At the edges of what is free a cell decides.
    std::erase_if(clear, [](std::size_t i) { return i == 0 || i == 17 || i == 42 || i == 46; });
    EXPECT_EQ(clear, expected);
    EXPECT_EQ(sectors_that_are(What::kObstacle, found), (std::vector<std::size_t>{60}));
  }
}

// Kills cells that are as wide as their side where they show their corner.
TEST(ObstacleSectors, ACellReachesIntoSectorsWithItsCorners) {
  const Pose pose = pose_from_rpy({0.05, 0.05, 0.05}, 0.0, 0.0, 0.0);  // in the middle of a cell
  for (const std::size_t middle : {0U, 18U, 36U, 54U}) {
    SCOPED_TRACE(middle);
    OccupancyMap map = empty_map();
    // The circle around it is 8.1 degrees to either side, its side would be 5.7.
    set(map, around(pose, 0.5, 5.0 * static_cast<double>(middle)), 2.0F);
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < 5; ++i) expected.push_back((middle + 70 + i) % 72);
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(sectors_that_are(What::kObstacle, nearest_obstacles(map, pose, {})), expected);
  }
  // Seen from aside: from 17.9 to 28.5 degrees to the right or left, by its side up to 27.0.
  struct Case {
    double left_m;
    std::vector<std::size_t> sectors;
  };
  for (const Case& c : {Case{-0.3, {4, 5, 6}}, Case{0.3, {66, 67, 68}}}) {
    OccupancyMap map = empty_map();
    set(map, pose * Eigen::Vector3d(0.7, c.left_m, 0.0), 2.0F);
    const ObstacleSectors found = nearest_obstacles(map, pose, {});
    EXPECT_EQ(sectors_that_are(What::kObstacle, found), c.sectors);
    for (const std::size_t i : c.sectors) EXPECT_NEAR(found.sectors[i].range_m, std::hypot(0.7, 0.3), 1e-9);
  }
}

// Kills left and right, or ahead and behind, that are swapped for some headings only.
TEST(ObstacleSectors, FourWallsAreEachWhereTheVehicleHasThem) {
  struct Wall {
    std::size_t sector;
    double range_m;
  };
  constexpr std::array kWalls = {Wall{0, 4.0}, Wall{18, 2.0}, Wall{36, 6.0},
                                 Wall{54, 3.0}};  // ahead, right, behind, left
  for (int heading = 0; heading < 360; heading += 15) {
    SCOPED_TRACE(heading);
    const Pose pose = pose_from_rpy({-1.0, 12.0, -3.0}, 0.0, 0.0, heading * kDegree_rad);
    OccupancyMap map = empty_map();
    for (const Wall& wall : kWalls) set(map, around(pose, wall.range_m, 5.0 * static_cast<double>(wall.sector)), 2.0F);
    const ObstacleSectors found = nearest_obstacles(map, pose, {});
    for (const Wall& wall : kWalls) {
      EXPECT_EQ(found.sectors[wall.sector].what, What::kObstacle) << wall.sector;
      EXPECT_NEAR(found.sectors[wall.sector].range_m, wall.range_m, 0.1) << wall.sector;
    }
    for (const std::size_t between : {9U, 27U, 45U, 63U}) EXPECT_EQ(found.sectors[between].what, What::kUnknown);
  }
}

TEST(ObstacleOptions, NameEachBrokenField) {
  EXPECT_TRUE(ObstacleOptions{}.validate());
  const auto broken = ObstacleOptions{.min_range_m = 2.0, .max_range_m = 1.0, .half_height_m = 0.0}.validate();
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().message.find("max_range_m"), std::string::npos);
  EXPECT_NE(broken.error().message.find("half_height_m"), std::string::npos);
}

}  // namespace
}  // namespace pingvox
