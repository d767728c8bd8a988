#include "pingvox/slam/slam_calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace pingvox::test {
namespace {

using testing::HasSubstr;

SlamCalibration a_calibration() {
  constexpr Estimate kSome{0.1, 0.01};
  return {"dvl", kSome, kSome, kSome, kSome, kSome, {{"compass", kSome, kSome, kSome, kSome, kSome}}};
}

TEST(SlamCalibration, RefusesWhatCannotBeBelievedOrInverted) {
  ASSERT_TRUE(a_calibration().validate());
  const auto reason = [](const SlamCalibration& c) { return c.validate().error().message; };
  SlamCalibration c = a_calibration();
  c.sonar_x_m.value = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(reason(c), HasSubstr("sonar_x_m"));
  c = a_calibration();
  c.headings[0].sin2_rad.deviation = 0.0;
  EXPECT_THAT(reason(c), HasSubstr("heading compass: sin2_rad"));
  c = a_calibration();
  c.velocity_scale.value = -1.0;
  EXPECT_THAT(reason(c), HasSubstr("velocity_scale"));
  c = a_calibration();
  c.headings[0].cos2_rad.value = 0.5;
  EXPECT_THAT(reason(c), HasSubstr("too large"));
  c = a_calibration();
  c.headings.push_back(c.headings[0]);
  EXPECT_THAT(reason(c), HasSubstr("twice"));
}

}  // namespace
}  // namespace pingvox::test
