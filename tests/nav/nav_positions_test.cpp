#include <gtest/gtest.h>

#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

TEST(NavPositions, AreMetresFromTheFirstFixAndNotTurned) {
  NavSource fixes{"gps", NavQuantity::kFix, {}};
  for (int i = 0; i < 3; ++i) {
    NavSample sample;
    sample.time_s = i;
    sample.value = {0.0, 1e-6 * i, 5.0 - i};
    fixes.samples.push_back(sample);
  }
  const auto log = NavLog::make({fixes}, NavClock::kUnknown);
  ASSERT_TRUE(log);
  EXPECT_FALSE(nav_trajectory(*log)) << "a vehicle is not mapped without its attitude";
  const auto made = nav_positions(*log, 10.0);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->attitude, "");
  // On the equator: 6,378,137 m times the angle.
  EXPECT_TRUE(made->trajectory.at(12.0)->isApprox(pose_from_rpy({12.756274, 0, -2}, 0, 0, 0), 1e-12));
  EXPECT_FALSE(nav_positions(*NavLog::make({}, NavClock::kUnknown)));
}

}  // namespace
}  // namespace pingvox
