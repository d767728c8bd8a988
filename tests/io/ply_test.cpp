#include <gtest/gtest.h>

#include "io/map_samples.hpp"
#include "io/two_occupied_leaves.hpp"

using namespace pingvox;
using namespace pingvox::samples;

namespace {

TEST(Ply, HoldsTheOccupiedLeavesOnly) {
  const Bytes expected = cloud_of_two_occupied_leaves(
      "ply\nformat binary_little_endian 1.0\ncomment occupied leaves of a map with cells of 0.5 m\nelement vertex 2\n"
      "property float x\nproperty float y\nproperty float z\nproperty float log_odds\nproperty float size\n"
      "end_header\n");
  EXPECT_EQ(to_bytes(map_of_two_occupied_leaves(), Format::kPly), expected);
}

TEST(Ply, OfAnEmptyMapHasNoVertex) {
  const Bytes bytes = to_bytes(OccupancyMap({.resolution_m = 0.5}), Format::kPly);
  EXPECT_NE(std::string(bytes.begin(), bytes.end()).find("element vertex 0\n"), std::string::npos);
}

}  // namespace
