#include "pingvox/slam/odometry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <tuple>
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

TEST(Odometry, TurnsByTheTurnRateIfAskedTo) {
  const NavLog log = log_of({source("imu", NavQuantity::kAttitude, 0.0, {0.0, 0.0, 1.0}),
                             source("imu", NavQuantity::kTurnRate, 0.0, {0.0, 0.0, 0.2})});
  const auto turned_rad = [&](TurnsBy turns) {
    const auto odometry = odometry_of(log, {.body_from_source = {}, .turns = turns});
    const Pose from = *odometry->odometry_from_body.at(0.0), to = *odometry->odometry_from_body.at(0.5);
    return Eigen::AngleAxisd(from.rotation().transpose() * to.rotation()).angle();
  };
  EXPECT_NEAR(turned_rad(TurnsBy::kHeading), 0.0, 1e-9);
  EXPECT_GT(turned_rad(TurnsBy::kTurnRate), 0.05);  // 0.1, less what the heading says of the bias
}

// Kills a log that is refused for a clock that the way does not depend on, and a way by one that was set back.
TEST(Odometry, IsRefusedForTheClocksThatItUses) {
  const auto with = [](NavQuantity quantity) {
    NavSource back = source("other", quantity, 0.0, {0.5, 0.0, 0.0});
    back.samples.back().time_s = 1.0;
    return odometry_of(log_of({source("dvl", NavQuantity::kVelocity, 0.0, {0.5, 0.1, 0.0}),
                               source("compass", NavQuantity::kHeading, 0.0, {0.0, 0.0, 0.0}), std::move(back)}),
                       {});
  };
  for (const NavQuantity quantity : {NavQuantity::kRange, NavQuantity::kFix, NavQuantity::kTemperature}) {
    EXPECT_TRUE(with(quantity)) << name_of(quantity);
  }
  for (const NavQuantity quantity : {NavQuantity::kVelocity, NavQuantity::kAttitude, NavQuantity::kDepth}) {
    const auto refused = with(quantity);
    ASSERT_FALSE(refused) << name_of(quantity);
    EXPECT_THAT(refused.error().message, testing::HasSubstr("of other runs back by 8.500 s"));
  }
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

/// A round way with errors of the sensors, or without them.
NavLog round_way(const SlamCalibration& errors) {
  NavSource velocity{"dvl", NavQuantity::kVelocity, {}}, attitude{"dvl", NavQuantity::kAttitude, {}};
  const HeadingCalibration& h = errors.headings.front();
  const Eigen::Vector2d measured = Eigen::Rotation2Dd(-errors.velocity_yaw_rad.value) * Eigen::Vector2d(0.5, 0.1) /
                                   (1.0 + errors.velocity_scale.value);
  for (int i = 0; i <= 400; ++i) {
    NavSample sample;
    sample.time_s = 0.25 * i;
    const double yaw = std::remainder(0.1 * sample.time_s, 2.0 * std::numbers::pi);
    sample.value << measured, 0.0;
    velocity.samples.push_back(sample);
    sample.value << 0.0, 0.0,
        yaw + errors.velocity_yaw_rad.value + h.constant_rad.value + h.sin1_rad.value * std::sin(yaw) +
            h.cos1_rad.value * std::cos(yaw) + h.sin2_rad.value * std::sin(2.0 * yaw) +
            h.cos2_rad.value * std::cos(2.0 * yaw);
    attitude.samples.push_back(sample);
  }
  return log_of({velocity, attitude});
}

TEST(Odometry, CalibrationTakesTheErrorsOfTheSensorsOff) {
  SlamCalibration none, errors;
  none.headings = {{"dvl", {}, {}, {}, {}, {}}};
  errors.velocity = "dvl";
  errors.velocity_yaw_rad = {0.2, 0.01};
  errors.velocity_scale = {0.03, 0.001};
  errors.headings = {{"dvl", {0.1, 0.01}, {0.08, 0.01}, {-0.05, 0.01}, {0.03, 0.01}, {0.02, 0.01}}};
  OdometryOptions calibrated;
  calibrated.calibration = errors;
  const auto truth = odometry_of(round_way(none), {}), raw = odometry_of(round_way(errors), {}),
             corrected = odometry_of(round_way(errors), calibrated);
  ASSERT_TRUE(truth && raw && corrected);
  const auto end = [](const Result<Odometry>& odometry) { return *odometry->odometry_from_body.at(70.0); };
  EXPECT_GT((end(raw).translation() - end(truth).translation()).norm(), 0.5);
  EXPECT_TRUE(end(corrected).isApprox(end(truth), 1e-9));
}

TEST(Odometry, RefusesACalibrationOfOtherSensors) {
  SlamCalibration other;
  other.velocity = "dvl";
  other.headings = {{"compass", {}, {}, {}, {}, {}}};
  OdometryOptions options;
  options.calibration = other;
  const auto refused = [&](const std::vector<NavSource>& sources) {
    return odometry_of(log_of(sources), options).error().message;
  };
  const NavSource compass = source("compass", NavQuantity::kHeading, 0.0, {0.0, 0.0, 0.0});
  EXPECT_THAT(refused({source("dvl", NavQuantity::kVelocity, 0.0, {0.5, 0.0, 0.0}),
                       source("imu", NavQuantity::kHeading, 0.0, {0.0, 0.0, 0.0})}),
              testing::HasSubstr("imu"));
  EXPECT_THAT(refused({source("A50", NavQuantity::kVelocity, 0.0, {0.5, 0.0, 0.0}), compass}),
              testing::HasSubstr("dvl, not of A50"));
}

// Kills dead reckoning that goes on through any silence: where nothing was heard for 10 s, there is no pose.
TEST(Odometry, HasAGapWhereItsSourcesAreSilent) {
  const auto silent = [](std::string name, NavQuantity quantity, const Eigen::Vector3d& value) {
    NavSource all = source(std::move(name), quantity, 0.0, value);
    for (std::size_t i = 11; i < all.samples.size(); ++i) all.samples[i].time_s += 10.0;
    return all;
  };
  const NavSource velocity = source("dvl", NavQuantity::kVelocity, 0.0, {0.5, 0.0, 0.0});
  const NavSource heading = source("compass", NavQuantity::kHeading, 0.0, {0.0, 0.0, 0.0});
  NavSource long_velocity = velocity, long_heading = heading;
  for (NavSource* all : {&long_velocity, &long_heading}) {
    while (all->samples.back().time_s < 20.0) {
      all->samples.push_back(all->samples.back());
      all->samples.back().time_s += 0.5;
    }
  }
  const NavSource silent_velocity = silent("dvl", NavQuantity::kVelocity, {0.5, 0.0, 0.0});
  const NavSource silent_heading = silent("compass", NavQuantity::kHeading, {0.0, 0.0, 0.0});
  using Case = std::tuple<const char*, const NavSource*, const NavSource*>;
  for (const auto& [name, of, yaw] :
       {Case("both", &silent_velocity, &silent_heading), Case("velocity", &silent_velocity, &long_heading),
        Case("heading", &long_velocity, &silent_heading)}) {
    const auto odometry = odometry_of(log_of({*of, *yaw}), {});
    ASSERT_TRUE(odometry) << odometry.error().message;
    EXPECT_EQ(odometry->odometry_from_body.gaps(), 1U) << name;
    EXPECT_TRUE(odometry->odometry_from_body.at(4.8)) << name;
    EXPECT_FALSE(odometry->odometry_from_body.at(10.0)) << name;
    EXPECT_TRUE(odometry->odometry_from_body.at(17.0)) << name;
  }
}

}  // namespace
}  // namespace pingvox::test
