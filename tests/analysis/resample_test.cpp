#include "pingvox/analysis/resample.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "support/uniform.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;
using Key64 = BasicKey<std::uint64_t>;

MapOptions cells_of(double resolution_m, int depth = 10) {
  MapOptions options;
  options.resolution_m = resolution_m;
  options.depth = depth;
  return options;
}

/// A room with free space in walls of one cell, one of which leans, and some cubes in it.
OccupancyMap room(std::mt19937_64& random, const MapOptions& options) {
  OccupancyMap map(options);
  Editor editor = map.edit();
  const std::uint64_t centre = std::uint64_t{1} << (options.depth - 1);
  constexpr std::uint64_t kSize = 24;
  for (std::uint64_t x = 0; x <= kSize; ++x) {
    for (std::uint64_t y = 0; y <= kSize; ++y) {
      for (std::uint64_t z = 0; z <= kSize / 2; ++z) {
        const bool is_wall = x == 0 || y == 0 || z == 0 || x == kSize || y == kSize || x == y / 3 + 12;
        const float belief =
            is_wall ? 1.0F + 0.1F * static_cast<float>(random() % 8) : -1.0F + 0.1F * static_cast<float>(random() % 2);
        if (random() % 50 != 0)
          editor.set(Key64{centre + x - 9, centre + y - 7, centre + z - 5}, options.depth, LogOdds(belief));
      }
    }
  }
  editor.set(Key64{centre + 64, centre + 32, centre}, options.depth - 4, LogOdds(-1.5F));
  editor.set(Key64{centre + 64, centre, centre}, options.depth - 2, LogOdds(2.0F));
  editor.synchronize();
  return map;
}

Pose random_pose(std::mt19937_64& random) {
  const auto angle = [&] { return test::uniform(random, -std::numbers::pi, std::numbers::pi); };
  return pose_from_rpy(
      {test::uniform(random, -2.0, 2.0), test::uniform(random, -2.0, 2.0), test::uniform(random, -2.0, 2.0)}, angle(),
      angle() / 2.0, angle());
}

/// Visits the middles of the cells of the finest resolution that leaves of a kind are made of.
template <class Visit>
void for_each_middle(const OccupancyMap& map, Occupancy what, Visit&& visit) {
  for_each_leaf(map, [&](const Leaf& leaf) {
    if (classify(leaf.belief, map.options().thresholds) != what) return;
    const std::uint64_t edge = std::uint64_t{1} << (map.lattice().depth() - leaf.depth);
    const Key64 low = leaf.key.as<std::uint64_t>();
    for (std::uint64_t x = 0; x < edge; ++x) {
      for (std::uint64_t y = 0; y < edge; ++y) {
        for (std::uint64_t z = 0; z < edge; ++z) visit(map.lattice().centre_of(Key64{low.x + x, low.y + y, low.z + z}));
      }
    }
  });
}

/// Whether a cell that is not free holds a point, or is beside the one that does.
bool is_occupied_near(const OccupancyMap& map, const Eigen::Vector3d& point_m) {
  const double cell_m = map.lattice().resolution_m();
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3d offset(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (map.classify(Eigen::Vector3d(point_m + cell_m * offset)) == Occupancy::kOccupied) return true;
  }
  return false;
}

TEST(Resample, LosesNoWallAndFreesNothingThatWasNotFree) {
  std::mt19937_64 random(17);
  for (int round = 0; round < 24; ++round) {
    SCOPED_TRACE(testing::Message() << "seed 17, round " << round);
    const OccupancyMap map = room(random, cells_of(0.1));
    const Pose moved = random_pose(random);
    const double resolution_m = 0.1 * std::exp(test::uniform(random, -0.7, 0.7));
    const auto out = resample(map, moved, cells_of(resolution_m));
    ASSERT_TRUE(out) << out.error().message;
    for_each_middle(map, Occupancy::kOccupied,
                    [&](const Eigen::Vector3d& middle) { EXPECT_TRUE(is_occupied_near(*out, moved * middle)); });
    std::size_t free = 0;
    for_each_middle(*out, Occupancy::kFree, [&](const Eigen::Vector3d& middle) {
      ++free;
      for (int point = 0; point < 8; ++point) {
        const Eigen::Vector3d within = middle + resolution_m * Eigen::Vector3d(test::uniform(random, -0.49, 0.49),
                                                                               test::uniform(random, -0.49, 0.49),
                                                                               test::uniform(random, -0.49, 0.49));
        ASSERT_EQ(map.classify(Eigen::Vector3d(moved.inverse() * within)), Occupancy::kFree);
      }
    });
    // Most of the free space stays: only cells at its border get lost.
    EXPECT_GT(static_cast<double>(free) * std::pow(resolution_m / 0.1, 3.0), 4096.0 * 0.5);
  }
}

TEST(Resample, AWallOfOneCellHasNoHoles) {
  // Its cells are turned: points in their middles alone would leave holes.
  OccupancyMap map(cells_of(0.1));
  {
    Editor editor = map.edit();
    for (std::uint64_t y = 500; y < 524; ++y) {
      for (std::uint64_t z = 500; z < 524; ++z) editor.set(Key64{512, y, z}, 10, LogOdds(2.0F));
    }
  }
  std::mt19937_64 random(3);
  for (int round = 0; round < 8; ++round) {
    const Pose turned = random_pose(random);
    const auto out = resample(map, turned, cells_of(0.1));
    ASSERT_TRUE(out);
    for (double y = -1.0; y <= 1.0; y += 0.037) {
      for (double z = -1.0; z <= 1.0; z += 0.041) {
        const Eigen::Vector3d from = turned * Eigen::Vector3d(-0.3, y, z);
        const Eigen::Vector3d aslant(1.0, test::uniform(random, -0.3, 0.3), test::uniform(random, -0.3, 0.3));
        const RayEnd end = cast_ray(*out, from, turned.linear() * aslant, 0.7);
        ASSERT_EQ(end.what, Occupancy::kOccupied) << "seed 3, round " << round << ", y " << y << ", z " << z;
      }
    }
  }
}

TEST(Resample, ByWholeCellsAndQuarterTurnsIsExact) {
  std::mt19937_64 random(5);
  const OccupancyMap map = room(random, cells_of(0.25));
  const Pose there = pose_from_rpy({2.5, -0.75, 1.25}, 0.0, 0.0, std::numbers::pi / 2.0);
  const auto moved = resample(map, there, cells_of(0.25));
  ASSERT_TRUE(moved);
  const MapCounts before = map.counts(), after = moved->counts();
  EXPECT_EQ(after.occupied_cells, before.occupied_cells);
  EXPECT_EQ(after.free_cells, before.free_cells);
  for (const Occupancy what : {Occupancy::kOccupied, Occupancy::kFree}) {
    for_each_middle(map, what, [&](const Eigen::Vector3d& middle) {
      ASSERT_EQ(moved->at(Eigen::Vector3d(there * middle)), map.at(middle));
    });
  }
}

TEST(Resample, ACellHasTheGreatestBeliefOfThoseThatAreNotFree) {
  std::mt19937_64 random(29);
  const OccupancyMap map = room(random, cells_of(0.1));
  const auto coarse = resample(map, Pose::Identity(), cells_of(0.2, 9));
  ASSERT_TRUE(coarse);
  for_each_middle(*coarse, Occupancy::kOccupied, [&](const Eigen::Vector3d& middle) {
    std::optional<LogOdds> greatest;
    for (int octant = 0; octant < 8; ++octant) {
      const Eigen::Vector3d offset((octant & 1) - 0.5, (octant >> 1 & 1) - 0.5, (octant >> 2) - 0.5);
      const auto belief = map.at(Eigen::Vector3d(middle + 0.1 * offset));
      if (belief && (!greatest || *belief > *greatest)) greatest = belief;
    }
    ASSERT_EQ(coarse->at(middle), greatest);
  });
}

// In cells much larger than those of the map, where a cell of the result overlaps thousands.
TEST(Resample, InLargeCellsFreesOnlyWhereAllIsFree) {
  std::mt19937_64 random(31);
  for (const double ratio : {4.5, 7.0, 12.0}) {
    SCOPED_TRACE(ratio);
    OccupancyMap map(cells_of(0.1));
    {
      Editor editor = map.edit();
      for (std::uint64_t x = 0; x < 90; ++x) {
        for (std::uint64_t y = 0; y < 90; ++y) {
          for (std::uint64_t z = 0; z < 40; ++z) {
            const float belief = x == 60 ? 1.5F : random() % 2 == 0 ? -1.0F : -0.5F;
            if (random() % 20000 != 0) editor.set(Key64{480 + x, 470 + y, 490 + z}, 10, LogOdds(belief));
          }
        }
      }
    }
    const Pose moved = pose_from_rpy({0.33, -0.21, 0.17}, 0.0, 0.0, 0.4);
    const double resolution_m = 0.1 * ratio;
    const auto out = resample(map, moved, cells_of(resolution_m));
    ASSERT_TRUE(out) << out.error().message;
    for_each_middle(map, Occupancy::kOccupied,
                    [&](const Eigen::Vector3d& middle) { ASSERT_TRUE(is_occupied_near(*out, moved * middle)); });
    std::size_t free = 0;
    for_each_middle(*out, Occupancy::kFree, [&](const Eigen::Vector3d& middle) {
      ++free;
      const LogOdds belief = *out->at(middle);
      for (int point = 0; point < 200; ++point) {
        const Eigen::Vector3d within = middle + resolution_m * Eigen::Vector3d(test::uniform(random, -0.49, 0.49),
                                                                               test::uniform(random, -0.49, 0.49),
                                                                               test::uniform(random, -0.49, 0.49));
        const auto from = map.at(Eigen::Vector3d(moved.inverse() * within));
        ASSERT_TRUE(from);
        ASSERT_LE(*from, belief);
      }
    });
    EXPECT_GT(free, 20U);
  }
}

TEST(AddMap, AddsLogOddsOfTheSamePlaces) {
  std::mt19937_64 random(8);
  const OccupancyMap map = room(random, cells_of(0.2));
  OccupancyMap sum = map;
  ASSERT_TRUE(add_map(map, Pose::Identity(), sum));
  for_each_middle(map, Occupancy::kFree, [&](const Eigen::Vector3d& middle) {
    const LogOdds once = *map.at(middle);
    ASSERT_EQ(sum.at(middle), add_evidence(once, once, map.options().clamp));
  });
  // A quarter turn there, and the map back in its place.
  const Pose there = pose_from_rpy({1.0, 0.0, 0.4}, 0.0, 0.0, std::numbers::pi / 2.0);
  OccupancyMap moved(cells_of(0.2)), back(cells_of(0.2));
  ASSERT_TRUE(add_map(map, there, moved));
  ASSERT_TRUE(add_map(moved, there.inverse(), back));
  EXPECT_EQ(back.counts().occupied_cells, map.counts().occupied_cells);
  for_each_middle(map, Occupancy::kOccupied,
                  [&](const Eigen::Vector3d& middle) { ASSERT_EQ(back.at(middle), map.at(middle)); });
}

TEST(Resample, RefusesWhatDoesNotFit) {
  OccupancyMap map(cells_of(0.1, 16));
  map.edit().set(Key64{}, 4, LogOdds(-1.0F));  // free, 400 m wide
  const auto outside = resample(map, Pose::Identity(), cells_of(0.1, 8));
  ASSERT_FALSE(outside);
  EXPECT_EQ(outside.error().code, Error::Code::kLimit);
  EXPECT_THAT(outside.error().message, HasSubstr("reaches farther than 12.8 m"));
  const auto fine = resample(map, Pose::Identity(), cells_of(0.001, 30));
  ASSERT_FALSE(fine);
  EXPECT_EQ(fine.error().code, Error::Code::kLimit);
  EXPECT_THAT(fine.error().message, HasSubstr("cells of 0.001 m"));
  EXPECT_EQ(resample(map, Pose::Identity(), cells_of(-1.0)).error().code, Error::Code::kBadOption);
  EXPECT_EQ(resample(map, Pose::Identity(), cells_of(0.1, 100)).error().code, Error::Code::kUnsupported);
}

}  // namespace
}  // namespace pingvox
