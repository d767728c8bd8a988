#include <gtest/gtest.h>

#include "pingvox/map/occupancy_map.hpp"

using namespace pingvox;

namespace {

Key key_at(int x, int y, int z) {
  const auto word = [](int cell) { return static_cast<std::uint16_t>(cell + 32768); };
  return {word(x), word(y), word(z)};
}

// The paper's table 1: a cube of 100^3 cells, updated cell by cell. (Its row of 19,769 leaves counts all nodes.)
TEST(OccupancyMap, CubeOfThePapersFirstTableHasItsNodes) {
  for (const Pruning pruning : {Pruning::kNever, Pruning::kLazy, Pruning::kEachUpdate}) {
    OccupancyMap map({.resolution_m = 1.0});
    {
      Editor editor = map.edit(pruning);
      for (int x = -50; x < 50; ++x) {
        for (int y = -50; y < 50; ++y) {
          for (int z = -50; z < 50; ++z) editor.update(key_at(x, y, z), LogOdds::from_probability(0.7));
        }
      }
    }
    const MapCounts counts = map.counts();
    EXPECT_EQ(counts.leaves, pruning == Pruning::kNever ? 1'000'000U : 14'568U);
    EXPECT_EQ(counts.inner, pruning == Pruning::kNever ? 145'977U : 5'201U);
    EXPECT_EQ(counts.occupied_cells, 1'000'000U);
  }
}

}  // namespace
