// Section 3.1 of the paper: an occupancy grid.
#include "bench/paper/dense_grid.hpp"

#include <gtest/gtest.h>

#include "bench/paper/tank_logs.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox::bench {
namespace {

TEST(DenseGrid, HoldsWhatTheOctreeHolds) {
  const TankLog log = simulated_tank();
  const Trajectory still = Trajectory::still(Pose::Identity());
  OccupancyMap map;
  BeamsInMemory beams(log.beams);
  ASSERT_TRUE(build_map(beams, still, {.filter = {}, .echo = {}, .model = {.shape = BeamShape::kRay}}, map));
  DenseGrid grid(map.lattice(), *map.bounds());
  for (const PlacedSweep& sweep : place_sweeps(log.beams, still)) grid.add(sweep);
  std::size_t cells = 0;
  for_each_leaf(map, {}, [&](const Leaf& leaf) {
    ++cells;
    const auto word = [](WideWord w) { return static_cast<std::uint16_t>(w); };
    EXPECT_EQ(grid.at({word(leaf.key.x), word(leaf.key.y), word(leaf.key.z)}), leaf.belief);
  });
  EXPECT_GT(cells, 5'000U);
  EXPECT_EQ(grid.known(), cells);
  EXPECT_EQ(grid.memory_bytes(), 4U * grid.size());
}

TEST(DenseGrid, KnowsNothingOutsideOfIt) {
  const Lattice lattice(0.1);
  const DenseGrid grid(lattice, {{-0.2, -0.1, 0.0}, {0.2, 0.1, 0.1}});
  EXPECT_EQ(grid.size(), 8U);
  EXPECT_FALSE(grid.at(*lattice.key_of({0.0, 0.0, 0.0})));
  EXPECT_FALSE(grid.at(*lattice.key_of({5.0, 0.0, 0.0})));
  EXPECT_FALSE(grid.at(*lattice.key_of({0.0, 0.0, 0.15})));
}

}  // namespace
}  // namespace pingvox::bench
