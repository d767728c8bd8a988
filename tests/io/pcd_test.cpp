#include <gtest/gtest.h>

#include "io/map_samples.hpp"
#include "io/two_occupied_leaves.hpp"
#include "pingvox/io/beams.hpp"

using namespace pingvox;
using namespace pingvox::samples;

namespace {

TEST(Pcd, HoldsTheOccupiedLeavesOnly) {
  const Bytes expected = cloud_of_two_occupied_leaves(
      "# .PCD v0.7 - Point Cloud Data file format\n# occupied leaves of a map with cells of 0.5 m\nVERSION 0.7\n"
      "FIELDS x y z log_odds size\nSIZE 4 4 4 4 4\nTYPE F F F F F\nCOUNT 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA binary\n");
  EXPECT_EQ(to_bytes(map_of_two_occupied_leaves(), Format::kPcd), expected);
}

/// The points of a cloud that was written.
std::vector<Eigen::Vector3d> read_back(const OccupancyMap& map, Format format) {
  const auto source = open_scans({"written", to_bytes(map, format)}, Damage::kFail);
  EXPECT_TRUE(source) << source.error().message;
  if (!source) return {};
  const auto scan = (*source)->next();
  EXPECT_TRUE(scan && *scan);
  return scan && *scan ? (*scan)->points_m : std::vector<Eigen::Vector3d>{};
}

TEST(Pcd, AndPlyAreReadBackAsTheyWereWritten) {
  std::mt19937_64 random(11);
  const OccupancyMap map = map_of(random_updates(random, 16, 3000), {.resolution_m = 0.05});
  std::vector<Eigen::Vector3d> centres;
  for_each_leaf(map, [&](const Leaf& leaf) {
    if (leaf.belief < LogOdds(0.0F)) return;
    centres.push_back(leaf.centre_m().cast<float>().cast<double>());
  });
  ASSERT_GT(centres.size(), 500U);
  EXPECT_EQ(read_back(map, Format::kPcd), centres);
  EXPECT_EQ(read_back(map, Format::kPly), centres);
  EXPECT_TRUE(read_back(OccupancyMap(), Format::kPcd).empty());
}

}  // namespace
