#include "pingvox/io/grids.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace pingvox {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr float kNoHeight = std::numeric_limits<float>::quiet_NaN();

/// Three columns, two rows: the lower one is free, unknown, occupied, the upper one unknown, free, free.
Raster<Occupancy> slice() {
  using enum Occupancy;
  return {3, 2, 0.05, {-0.1, 2.35}, {kFree, kUnknown, kOccupied, kUnknown, kFree, kFree}};
}

std::string yaml(const Raster<Occupancy>& grid, std::string_view image) {
  std::ostringstream out;
  EXPECT_TRUE(write_grid_yaml(grid, image, out));
  return out.str();
}

TEST(Grid, HasItsHighestRowFirst) {
  std::ostringstream out;
  ASSERT_TRUE(write_grid_pgm(slice(), out));
  EXPECT_EQ(out.str(), "P5\n# pingvox, 0.05 m a pixel\n3 2\n255\n\xcd\xfe\xfe\xfe\xcd" + std::string(1, '\0'));
}

TEST(Grid, SaysWhereItsLowestCornerIs) {
  EXPECT_EQ(yaml(slice(), "grid.pgm"),
            "image: grid.pgm\nmode: trinary\nresolution: 0.05\norigin: [-0.1, 2.35, 0.0]\nnegate: 0\n"
            "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
}

TEST(Grid, KeepsUnknownApartFromFreeByTheRulesOfItsReaders) {
  // map_server compares (255 - p) / 255 with the thresholds, nav2 1 - p / 255, both without the equal case.
  for (const double occupied : {(255.0 - 205.0) / 255.0, 1.0 - 205.0 / 255.0}) {
    EXPECT_FALSE(occupied > 0.65);
    EXPECT_FALSE(occupied < 0.196);
  }
  EXPECT_LT((255.0 - 254.0) / 255.0, 0.196);
}

TEST(Grid, QuotesNamesThatYamlWouldReadOtherwise) {
  EXPECT_THAT(yaml(slice(), "my grid: #1.pgm"), StartsWith("image: \"my grid: #1.pgm\"\n"));
  EXPECT_THAT(yaml(slice(), "a\"b\\c\nd.pgm"), StartsWith("image: \"a\\\"b\\\\c\\x0Ad.pgm\"\n"));
}

TEST(Grid, HasNoRoundingInItsLengthsAndNoExponent) {
  auto grid = slice();
  grid.corner_m = {-2.5500000000000003, 0.0000125};
  EXPECT_THAT(yaml(grid, "g.pgm"), HasSubstr("origin: [-2.55, 0.00001250000000000000, 0.0]\n"));
}

TEST(Heights, HaveTheirHighestRowFirstAndAValueForNone) {
  std::ostringstream out;
  ASSERT_TRUE(write_heights_asc({2, 2, 0.5, {-1.0, 3.5}, {-1.5F, kNoHeight, kNoHeight, 0.25F}}, out));
  EXPECT_EQ(
      out.str(),
      "ncols 2\nnrows 2\nxllcorner -1\nyllcorner 3.5\ncellsize 0.5\nNODATA_value -9999\n-9999 0.25\n-1.5 -9999\n");
}

TEST(Heights, BelowTheUsualValueForNoneAreNotTakenForIt) {
  std::ostringstream out;
  ASSERT_TRUE(write_heights_asc({2, 1, 1.0, {0.0, 0.0}, {-9999.0F, kNoHeight}}, out));
  EXPECT_THAT(out.str(), HasSubstr("NODATA_value -3.4e+38\n-9999 -3.4e+38\n"));
}

TEST(Grid, SaysWhenItCouldNotBeWritten) {
  std::ostringstream closed;
  closed.setstate(std::ios::badbit);
  EXPECT_FALSE(write_grid_pgm(slice(), closed));
  EXPECT_FALSE(write_grid_yaml(slice(), "a.pgm", closed));
  EXPECT_FALSE(write_heights_asc({1, 1, 1.0, {0.0, 0.0}, {1.0F}}, closed));
}

}  // namespace
}  // namespace pingvox
