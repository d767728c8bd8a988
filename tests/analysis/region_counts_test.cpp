#include "pingvox/analysis/region_counts.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "support/uniform.hpp"

namespace pingvox {
namespace {

using Key64 = BasicKey<std::uint64_t>;

TEST(CountsIn, AreThoseOfEachCellWhoseMiddleIsInTheBox) {
  std::mt19937_64 random(77);
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(testing::Message() << "seed 77, round " << round);
    MapOptions options;
    options.resolution_m = 0.3;
    options.depth = 1 + round % 4;
    options.thresholds = {LogOdds(-0.5F), LogOdds(0.5F)};
    OccupancyMap map(options);
    const std::uint64_t side = std::uint64_t{1} << options.depth;
    {
      Editor editor = map.edit();
      for (int i = 0; i < 20; ++i) {
        const int up = static_cast<int>(random() % 2);
        const auto word = [&] { return random() % side >> up << up; };
        editor.set(Key64{word(), word(), word()}, options.depth - up,
                   LogOdds(static_cast<float>(static_cast<int>(random() % 3) - 1)));
      }
    }
    const auto corner = [&] {
      return Eigen::Vector3d(test::uniform(random, -3.0, 3.0), test::uniform(random, -3.0, 3.0),
                             test::uniform(random, -3.0, 3.0));
    };
    const Eigen::Vector3d a = corner(), b = corner();
    const Box box{a.cwiseMin(b), a.cwiseMax(b)};
    RegionCounts expected;
    for (std::uint64_t i = 0; i < side * side * side; ++i) {
      const Key64 key{i % side, i / side % side, i / side / side};
      const Eigen::Vector3d middle = map.lattice().centre_of(key);
      if ((middle.array() < box.min.array()).any() || (middle.array() > box.max.array()).any()) continue;
      ++expected.cells;
      if (!map.at(key)) continue;
      ++(map.classify(key) == Occupancy::kOccupied ? expected.occupied_cells
         : map.classify(key) == Occupancy::kFree   ? expected.free_cells
                                                   : expected.undecided_cells);
    }
    const RegionCounts counts = counts_in(map, box);
    EXPECT_EQ(counts.cells, expected.cells);
    EXPECT_EQ(counts.occupied_cells, expected.occupied_cells);
    EXPECT_EQ(counts.free_cells, expected.free_cells);
    EXPECT_EQ(counts.undecided_cells, expected.undecided_cells);
  }
}

TEST(CountsIn, OfAllSpaceAreThoseOfTheMap) {
  OccupancyMap map(MapOptions{.depth = 30});
  map.edit().set(Key64{}, 3, LogOdds(-1.0F));
  const double inf = std::numeric_limits<double>::infinity();
  const RegionCounts counts = counts_in(map, {Eigen::Vector3d::Constant(-inf), Eigen::Vector3d::Constant(inf)});
  EXPECT_EQ(counts.cells, UINT64_MAX);
  EXPECT_EQ(counts.free_cells, map.counts().free_cells);
}

}  // namespace
}  // namespace pingvox
