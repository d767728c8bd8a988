#include "slam/smoother/map_walls.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pingvox/map/occupancy_map.hpp"
#include "support/room.hpp"

namespace pingvox::test {
namespace {

/// Free water in cells of 5 cm with one round pile, of which all is occupied.
DistanceField pile(double radius_m) {
  OccupancyMap map;
  auto editor = map.edit();
  for (double x = -1.975; x < 2.0; x += 0.05) {
    for (double y = -1.975; y < 2.0; y += 0.05) {
      const auto key = map.lattice().key_of(Eigen::Vector3d(x, y, 0.01));
      editor.update(*key, LogOdds(std::hypot(x, y) < radius_m ? 2.0F : -2.0F));
    }
  }
  editor.synchronize();
  return *DistanceField::make(map, {});
}

TEST(MapWalls, AreLinesThroughTheColumnsAround) {
  const MapWalls walls(*DistanceField::make(Room{}.map(), {}));
  const auto wall = walls.nearest({2.8, -0.5}, {1.0, 0.0}, 0.5);
  ASSERT_TRUE(wall);
  EXPECT_NEAR(std::abs(wall->normal.x()), 1.0, 1e-6);
  EXPECT_NEAR(wall->place_m.x(), 3.05, 0.03);  // the middle of its thickness
  EXPECT_FALSE(walls.nearest({0.0, 0.0}, {1.0, 0.0}, 0.5));
}

// Kills a hull that no echo is matched with, as its columns form no line.
TEST(MapWalls, AreTheOutlineOfWhatIsFilled) {
  const MapWalls walls(*DistanceField::make(Room{}.map(), {}));
  for (const double x : {1.9, 2.1}) {  // before and behind the face of the block
    const auto wall = walls.nearest({x, 1.5}, {1.0, 0.0}, 0.5);
    ASSERT_TRUE(wall);
    EXPECT_NEAR(wall->normal.x(), -1.0, 1e-6);
    EXPECT_NEAR(wall->place_m.x(), 2.025, 0.001);
  }
}

// Kills an echo that is drawn to the far side of a pile since that is nearer.
TEST(MapWalls, AreTheSideOfAPileThatIsSeen) {
  const MapWalls walls(pile(0.25));
  for (const double turn_rad : {0.0, 0.8, 2.5, -1.9}) {
    SCOPED_TRACE(turn_rad);
    const Eigen::Vector2d ray(std::cos(turn_rad), std::sin(turn_rad));
    for (const double along_m : {-0.5, -0.25, -0.1, 0.1, 0.25}) {
      SCOPED_TRACE(along_m);
      const auto wall = walls.nearest(along_m * ray, ray, 0.6);
      ASSERT_TRUE(wall);
      EXPECT_LT(wall->normal.dot(ray), 0.0);
      EXPECT_LT(wall->place_m.dot(ray), 0.0);
    }
    const auto wall = walls.nearest(-0.25 * ray, ray, 0.6);
    EXPECT_LT(wall->normal.dot(ray), -0.9);
    EXPECT_NEAR(wall->place_m.dot(ray), -0.2, 0.05);
  }
}

// Kills a search through two milliards of squares for a pose that has left the world.
TEST(MapWalls, AreNotWhereNoMapReaches) {
  const MapWalls walls(*DistanceField::make(Room{}.map(), {}));
  for (const double far : {1e9, 1e300, std::nan("")}) {
    EXPECT_FALSE(walls.nearest({far, 0.0}, {1.0, 0.0}, 10.0));
    EXPECT_FALSE(walls.nearest({0.0, -far}, {1.0, 0.0}, 10.0));
  }
}

/// A wall along y of 21 cells, each of an edge, around a place.
DistanceField wall_at(const Eigen::Vector2d& place_m, double edge_m) {
  OccupancyMap map({.resolution_m = edge_m, .depth = 62});
  auto editor = map.edit();
  for (int n = -10; n <= 10; ++n) {
    const auto key = map.lattice().key_of<WideWord>(Eigen::Vector3d(place_m.x(), place_m.y() + n * edge_m, 0.0));
    editor.update(*key, LogOdds(2.0F));
  }
  editor.synchronize();
  return *DistanceField::make(map, {});
}

// Kills squares without a number: those beyond 32 bits.
TEST(MapWalls, AreFoundAsFarFromTheOriginAsMapsReach) {
  for (const double far_m : {0.0, 1e3, 3e9, -3e9, 1e12}) {
    SCOPED_TRACE(far_m);
    const Eigen::Vector2d place(far_m + 0.0625, -far_m + 0.0625);
    const MapWalls walls(wall_at(place, 0.125));
    const auto wall = walls.nearest(place + Eigen::Vector2d(-0.3, 0.0), {1.0, 0.0}, 0.5);
    ASSERT_TRUE(wall);
    EXPECT_NEAR(std::abs(wall->normal.x()), 1.0, 1e-6);
    EXPECT_NEAR(wall->place_m.x(), place.x(), 1e-3);
    EXPECT_FALSE(walls.nearest(place + Eigen::Vector2d(-0.6, 0.0), {1.0, 0.0}, 0.5));
  }
  const MapWalls walls(wall_at({0.0, 0.0}, 0.125));
  for (const double no_place : {1e300, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_FALSE(walls.nearest({no_place, 0.0}, {1.0, 0.0}, 0.5)) << no_place;
  }
}

// Kills squares that are so much smaller than cells that to look through them never ends.
TEST(MapWalls, MayHaveCellsOfAnySize) {
  const MapWalls walls(wall_at({0.0, 0.0}, 1e4));
  const auto wall = walls.nearest({-1e4, 0.0}, {1.0, 0.0}, 2e4);
  ASSERT_TRUE(wall);
  EXPECT_NEAR(std::abs(wall->normal.x()), 1.0, 1e-6);
}

}  // namespace
}  // namespace pingvox::test
