#include <gtest/gtest.h>

#include "io/map_samples.hpp"

using namespace pingvox;
using namespace pingvox::samples;

namespace {

TEST(Ply, HoldsTheOccupiedLeavesOnly) {
  OccupancyMap map({.resolution_m = 0.5, .depth = 16});
  {
    Editor editor = map.edit();
    editor.set(Key{32768, 32768, 32768}, 16, LogOdds(1.0F));   // middle 0.25, 0.25, 0.25
    editor.set(Key{32770, 32768, 32764}, 15, LogOdds(2.0F));   // edge 1, middle 1.5, 0.5, -1.5
    editor.set(Key{32780, 32768, 32768}, 16, LogOdds(-1.0F));  // free
  }
  Bytes expected = bytes_of(
      "ply\nformat binary_little_endian 1.0\ncomment occupied leaves of a map with cells of 0.5 m\nelement vertex 2\n"
      "property float x\nproperty float y\nproperty float z\nproperty float log_odds\nproperty float size\n"
      "end_header\n");
  const Bytes body = bytes_of_hex(
      "0000c03f 0000003f 0000c0bf 00000040 0000803f"
      "0000803e 0000803e 0000803e 0000803f 0000003f");
  expected.insert(expected.end(), body.begin(), body.end());
  EXPECT_EQ(written(map, Format::kPly), expected);
}

TEST(Ply, OfAnEmptyMapHasNoVertex) {
  const Bytes bytes = written(OccupancyMap({.resolution_m = 0.5}), Format::kPly);
  EXPECT_NE(std::string(bytes.begin(), bytes.end()).find("element vertex 0\n"), std::string::npos);
}

}  // namespace
