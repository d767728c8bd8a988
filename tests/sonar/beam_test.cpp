#include "pingvox/sonar/beam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace pingvox {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

TEST(WrappedBearing, NeverReturnsAWholeTurn) {
  for (const double angle :
       {-1e-300, -1e-17, -1e-9, kTurn, -kTurn, 1e15, -1e15, std::nextafter(kTurn, 0.0), 3 * kTurn}) {
    SCOPED_TRACE(angle);
    EXPECT_GE(wrapped_bearing(angle), 0.0);
    EXPECT_LT(wrapped_bearing(angle), kTurn);
  }
  EXPECT_DOUBLE_EQ(wrapped_bearing(-std::numbers::pi / 2), 1.5 * std::numbers::pi);
}

TEST(ValidateBeam, RefusesWhatItsCommentsRuleOut) {
  const Beam good{.time_s = 1.0, .bearing_rad = 1.0, .bin_length_m = 0.1, .intensities = {1, 2}};
  EXPECT_TRUE(validate(good));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    Beam beam = good;
    beam.time_s = bad;
    EXPECT_FALSE(validate(beam)) << bad;
  }
  for (const double bad : {nan, -0.1, kTurn, infinity}) {
    Beam beam = good;
    beam.bearing_rad = bad;
    EXPECT_FALSE(validate(beam)) << bad;
  }
  for (const double bad : {nan, 0.0, -0.1, infinity, 1e9}) {
    Beam beam = good;
    beam.bin_length_m = bad;
    EXPECT_FALSE(validate(beam)) << bad;
  }
}

}  // namespace
}  // namespace pingvox
