#include "pingvox/mapping/map_resolution.hpp"

#include <gtest/gtest.h>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::test {
namespace {

constexpr double kThreeDegrees_rad = 3.0 * kDegree_rad;

TEST(MapResolution, IsFineNearbyAndAsOneWouldTypeItFarAway) {
  for (const double range_m : {0.0, 1.98, 5.0, 10.0}) {
    EXPECT_EQ(resolution_for(range_m, kThreeDegrees_rad), MapOptions::kDefaultResolution_m) << range_m;
  }
  EXPECT_EQ(resolution_for(20.0, kThreeDegrees_rad), 0.1);
  EXPECT_EQ(resolution_for(50.0, kThreeDegrees_rad), 0.25);
  EXPECT_EQ(resolution_for(59.985, 2.0 * kDegree_rad), 0.2);
  EXPECT_EQ(resolution_for(30.0, 2.0 * kDegree_rad), 0.1);
}

TEST(MapResolution, GrowsWithRangeAndWidthInSmallSteps) {
  std::size_t cases = 0;
  for (const double width_deg : {0.0, 0.5, 1.0, 2.0, 3.0, 8.0}) {
    double last_m = MapOptions::kDefaultResolution_m;
    for (double range_m = 1.0; range_m <= 300.0; ++range_m, ++cases) {
      const double cell_m = resolution_for(range_m, width_deg * kDegree_rad);
      EXPECT_GE(cell_m, last_m) << range_m;
      EXPECT_LE(cell_m, last_m + 0.0501) << range_m;
      EXPECT_GE(cell_m, resolution_for(range_m, 0.5 * width_deg * kDegree_rad)) << range_m;
      last_m = cell_m;
    }
  }
  EXPECT_EQ(cases, 1800U);
}

// Kills a map of a live head in other cells than the map of its recording: the head samples a little farther, or less
// far, than it was asked to.
TEST(MapResolution, IsThatOfTheRangeThatWasAskedFor) {
  for (int range_m = 2; range_m <= 100; ++range_m) {
    for (const double apart_m : {-0.4, -0.02, 0.03, 0.4}) {
      EXPECT_EQ(resolution_for(range_m + apart_m, kThreeDegrees_rad), resolution_for(range_m, kThreeDegrees_rad));
    }
  }
}

}  // namespace
}  // namespace pingvox::test
