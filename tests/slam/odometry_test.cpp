#include "pingvox/slam/odometry.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <utility>
#include <vector>

namespace pingvox::test {
namespace {

NavSource source(std::string name, NavQuantity quantity, double from_s, const Eigen::Vector3d& value) {
  NavSource all{std::move(name), quantity, {}};
  for (int i = 0; i <= 20; ++i) {
    NavSample sample;
    sample.time_s = from_s + 0.5 * i;
    sample.value = value;
    all.samples.push_back(sample);
  }
  return all;
}

NavLog log_of(std::vector<NavSource> sources) {
  return *NavLog::make(std::move(sources), NavClock::kUnknown);
}

TEST(Odometry, GoesAlongTheHeading) {
  const auto odometry =
      odometry_of(log_of({source("dvl", NavQuantity::kVelocity, 0.0, {0.5, 0.1, 0.0}),
                          source("compass", NavQuantity::kHeading, 0.0, {std::numbers::pi / 2.0, 0.0, 0.0}),
                          source("bar", NavQuantity::kDepth, 0.0, {3.0, 0.0, 0.0})}),
                  {.body_from_source = {}, .offset_s = 100.0});
  ASSERT_TRUE(odometry) << odometry.error().message;
  const auto end = odometry->odometry_from_body.at(110.0);
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->translation().isApprox(Eigen::Vector3d(-1.0, 5.0, -3.0), 1e-9)) << end->translation().transpose();
  EXPECT_EQ(odometry->velocity, "dvl");
}

TEST(Odometry, StaysWithoutVelocityAndNeedsAHeading) {
  const auto turns = odometry_of(log_of({source("imu", NavQuantity::kAttitude, 0.0, {0.0, 0.0, 1.0})}), {});
  ASSERT_TRUE(turns);
  EXPECT_TRUE(turns->velocity.empty());
  EXPECT_EQ(turns->odometry_from_body.at(5.0)->translation(), Eigen::Vector3d::Zero());
  EXPECT_FALSE(odometry_of(log_of({source("dvl", NavQuantity::kVelocity, 0.0, {0.5, 0.0, 0.0})}), {}));
  EXPECT_FALSE(odometry_of(log_of({source("dvl", NavQuantity::kVelocity, 0.0, {0.5, 0.0, 0.0}),
                                   source("imu", NavQuantity::kHeading, 100.0, {0.0, 0.0, 0.0})}),
                           {}));
}

}  // namespace
}  // namespace pingvox::test
