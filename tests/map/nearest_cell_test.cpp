#include "pingvox/map/nearest_cell.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/uniform.hpp"

namespace pingvox {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

MapOptions lattice_of(int depth, Parents parents = Parents::kMax) {
  MapOptions options;
  options.resolution_m = 0.5;
  options.depth = depth;
  options.parents = parents;
  options.thresholds = {LogOdds(-0.5F), LogOdds(0.5F)};
  return options;
}

/// Cubes of random size and belief, some of them undecided.
OccupancyMap random_map(std::mt19937_64& random, const MapOptions& options) {
  OccupancyMap map(options);
  Editor editor = map.edit();
  for (int i = 0; i < 25; ++i) {
    const int up = static_cast<int>(random() % 3) % (options.depth + 1);
    const std::uint64_t cells = std::uint64_t{1} << options.depth, edge = std::uint64_t{1} << up;
    const auto word = [&] { return random() % cells / edge * edge; };
    editor.set(BasicKey<std::uint64_t>{word(), word(), word()}, options.depth - up,
               LogOdds(static_cast<float>(static_cast<int>(random() % 3) - 1)));
  }
  return map;
}

/// The range to the nearest cell of a kind, by looking at each cell of the lattice.
double nearest_by_looking_at_all(const OccupancyMap& map, const Eigen::Vector3d& point_m, Sought sought) {
  const std::uint64_t cells = std::uint64_t{1} << map.lattice().depth();
  double nearest_m = kFar;
  for (std::uint64_t x = 0; x < cells; ++x) {
    for (std::uint64_t y = 0; y < cells; ++y) {
      for (std::uint64_t z = 0; z < cells; ++z) {
        const BasicKey<std::uint64_t> key{x, y, z};
        const Occupancy what = map.classify(key);
        if (what == Occupancy::kFree || (sought == Sought::kOccupied && what == Occupancy::kUnknown)) continue;
        const Eigen::Array3d beyond =
            ((map.lattice().centre_of(key) - point_m).array().abs() - 0.5 * map.lattice().resolution_m()).max(0.0);
        nearest_m = std::min(nearest_m, beyond.matrix().norm());
      }
    }
  }
  return nearest_m;
}

TEST(NearestCell, IsTheNearestOfAllCells) {
  std::mt19937_64 random(41);
  for (int round = 0; round < 60; ++round) {
    const OccupancyMap map =
        random_map(random, lattice_of(1 + round % 4, round % 2 == 0 ? Parents::kMax : Parents::kMean));
    const Eigen::Vector3d point_m(test::uniform(random, -5.0, 5.0), test::uniform(random, -5.0, 5.0),
                                  test::uniform(random, -5.0, 5.0));
    for (const Sought sought : {Sought::kOccupied, Sought::kNotFree}) {
      SCOPED_TRACE(testing::Message() << "seed 41, round " << round);
      const double expected_m = nearest_by_looking_at_all(map, point_m, sought);
      const auto found = nearest_cell(map, point_m, kFar, sought);
      ASSERT_EQ(found.has_value(), expected_m < kFar);
      if (!found) continue;
      EXPECT_NEAR(found->range_m, expected_m, 1e-12);
      EXPECT_NEAR((found->point_m - point_m).norm(), expected_m, 1e-12);
      // Within a range that just holds it, and not within one that does not.
      EXPECT_TRUE(nearest_cell(map, point_m, expected_m * (1.0 + 1e-9), sought));
      if (expected_m > 0.0) {
        EXPECT_FALSE(nearest_cell(map, point_m, expected_m * (1.0 - 1e-9), sought));
      }
    }
  }
}

TEST(NearestCell, OfAnEmptyMapIsUnknownSpace) {
  const OccupancyMap map(lattice_of(4));
  EXPECT_FALSE(nearest_cell(map, Eigen::Vector3d::Zero(), kFar));
  const auto unknown = nearest_cell(map, {1.0, 0.0, 0.0}, 0.0, Sought::kNotFree);
  ASSERT_TRUE(unknown);
  EXPECT_EQ(unknown->what, Occupancy::kUnknown);
  EXPECT_EQ(unknown->range_m, 0.0);
}

}  // namespace
}  // namespace pingvox
