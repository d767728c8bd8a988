// Velocities and headings as dead reckoning takes them.

#include "nav/internal/navigation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/uniform.hpp"

namespace pingvox::test {
namespace {

constexpr double kPi = std::numbers::pi;

NavSource velocities(std::size_t count, double step_s, const auto& velocity) {
  NavSource source{"dvl", NavQuantity::kVelocity, {}};
  for (std::size_t i = 0; i < count; ++i) {
    NavSample sample;
    sample.time_s = step_s * static_cast<double>(i);
    sample.value = velocity(i);
    source.samples.push_back(sample);
  }
  return source;
}

TEST(VelocitySource, HoldsAnOutlierNearItsNeighboursButFollowsARamp) {
  const NavSource ramp = velocities(
      30, 0.5, [](std::size_t i) { return Eigen::Vector3d(i == 15 ? 5.0 : 0.02 * static_cast<double>(i), 0.1, 0.0); });
  const auto velocity = velocity_source(ramp, Pose::Identity());
  ASSERT_TRUE(velocity);
  EXPECT_EQ(velocity->clipped, 1U);
  EXPECT_NEAR(velocity->ahead.values()[15], 0.3, 0.2);
  for (const std::size_t i : {std::size_t{5}, std::size_t{14}, std::size_t{16}, std::size_t{25}}) {
    EXPECT_EQ(velocity->ahead.values()[i], ramp.samples[i].value.x()) << i;
  }
}

TEST(VelocitySource, LeavesOutInvalidSamples) {
  NavSource source = velocities(10, 0.5, [](std::size_t) { return Eigen::Vector3d(0.2, 0.0, 0.0); });
  source.samples[4].value.x() = 327.67;
  source.samples[4].valid = false;
  const auto velocity = velocity_source(source, Pose::Identity());
  ASSERT_TRUE(velocity);
  EXPECT_EQ(velocity->ahead.size(), 9U);
  EXPECT_EQ(velocity->ahead.at(2.0), 0.2);
}

TEST(VelocitySource, MeasuresNoiseWhateverTheVehicleDoes) {
  std::mt19937_64 random(1);
  const double edge = 0.1 * std::sqrt(3.0);  // uniform noise of 0.1 m/s
  const NavSource noisy = velocities(600, 0.25, [&](std::size_t i) {
    const double ahead = std::sin(0.05 * static_cast<double>(i));
    return Eigen::Vector3d(ahead + uniform(random, -edge, edge), uniform(random, -edge, edge), 0.0);
  });
  const auto velocity = velocity_source(noisy, Pose::Identity());
  ASSERT_TRUE(velocity);
  EXPECT_NEAR(velocity->density.at(75.0), 0.1 * std::sqrt(0.25), 0.012);
}

// Kills a velocity that is believed to the millimetre because it stays the same.
TEST(VelocitySource, IsNotSurerThanDataSheetsAre) {
  const auto velocity = velocity_source(
      velocities(100, 0.1, [](std::size_t) { return Eigen::Vector3d(0.5, 0.0, 0.0); }), Pose::Identity());
  ASSERT_TRUE(velocity);
  EXPECT_DOUBLE_EQ(velocity->density.at(5.0), 0.02);
}

TEST(VelocitySource, IsTurnedByItsMount) {
  const NavSource ahead = velocities(5, 0.5, [](std::size_t) { return Eigen::Vector3d(1.0, 0.0, 0.0); });
  const auto velocity = velocity_source(ahead, pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, kPi / 2.0));
  ASSERT_TRUE(velocity);
  EXPECT_NEAR(velocity->ahead.at(1.0), 0.0, 1e-12);
  EXPECT_NEAR(velocity->left.at(1.0), 1.0, 1e-12);
}

TEST(HeadingSource, GoesOnPastTheHalfTurnAndTakesOffItsMount) {
  NavSource source{"compass", NavQuantity::kHeading, {}};
  for (int i = 0; i < 20; ++i) {
    NavSample sample;
    sample.time_s = i;
    sample.value.x() = std::remainder(0.5 * i, 2.0 * kPi);
    source.samples.push_back(sample);
  }
  const auto heading = heading_source(source, pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, -0.3));
  ASSERT_TRUE(heading);
  EXPECT_NEAR(heading->yaw_rad.at(0.0), 0.3, 1e-12);
  EXPECT_NEAR(heading->yaw_rad.at(19.0), 9.8, 1e-12);
  EXPECT_NEAR(heading->yaw_rad.at(6.5), 3.55, 1e-12) << "between 6 and 7 it passes the half turn";
}

/// A vehicle that turns to and fro for `duration_s`: by a gyro with a bias, and by a compass that deviates.
struct Turning {
  NavSource rate{"imu", NavQuantity::kTurnRate, {}}, compass{"imu", NavQuantity::kHeading, {}};
  static double yaw_rad(double time_s) { return 2.0 * std::sin(0.1 * time_s); }

  Turning(double duration_s, double bias_rad_s) {
    for (double time_s = 0.0; time_s <= duration_s; time_s += 0.1) {
      NavSample sample;
      sample.time_s = time_s;
      sample.value = {0.0, 0.0, 0.2 * std::cos(0.1 * time_s) + bias_rad_s};
      rate.samples.push_back(sample);
      sample.value = {yaw_rad(time_s) + 0.08 * std::sin(yaw_rad(time_s)) - 0.05 * std::cos(yaw_rad(time_s)), 0.0, 0.0};
      compass.samples.push_back(sample);
    }
  }
};

// Kills a bias that is added, and turns that are the compass's.
TEST(GyroHeading, TurnsAsTheBodyDoesAndDriftsLittle) {
  const Turning turning(300.0, 0.5 * kPi / 180.0);
  const auto compass = heading_source(turning.compass, Pose::Identity());
  const auto heading = gyro_heading(turning.rate, Pose::Identity(), *compass);
  ASSERT_TRUE(heading);
  const auto off_rad = [&](double time_s) { return heading->yaw_rad.at(time_s) - Turning::yaw_rad(time_s); };
  // The bias alone would make 2.6 rad in this time.
  EXPECT_NEAR(off_rad(300.0), off_rad(0.0), 0.12);
  for (double time_s = 10.0; time_s < 300.0; time_s += 10.0) {
    EXPECT_NEAR(off_rad(time_s), off_rad(time_s - 10.0), 0.01) << time_s;
  }
}

TEST(GyroHeading, NeedsAGyroThatSpeaksAllTheTime) {
  const Turning turning(60.0, 0.0);
  const auto compass = heading_source(turning.compass, Pose::Identity());
  NavSource gap = turning.rate, half = turning.rate;
  gap.samples.erase(gap.samples.begin() + 200, gap.samples.begin() + 220);
  half.samples.resize(300);
  EXPECT_TRUE(gyro_heading(turning.rate, Pose::Identity(), *compass));
  EXPECT_FALSE(gyro_heading(gap, Pose::Identity(), *compass));
  EXPECT_FALSE(gyro_heading(half, Pose::Identity(), *compass));
}

TEST(TimeSeries, KnowsItsGaps) {
  const TimeSeries series({0.0, 1.0, 2.0, 3.0, 13.0, 14.0, 15.0, 16.0}, {0, 1, 2, 3, 13, 14, 15, 16});
  EXPECT_EQ(series.at(8.0), 8.0);
  EXPECT_EQ(series.gap_s(0.0, 3.0), 0.0);
  EXPECT_EQ(series.gap_s(2.0, 5.0), 2.0);
  EXPECT_EQ(series.gap_s(4.0, 5.0), 1.0);
  EXPECT_EQ(series.gap_s(-2.0, 20.0), 2.0 + 10.0 + 4.0);
  EXPECT_EQ(series.longest_step_s(), 10.0);
}

}  // namespace
}  // namespace pingvox::test
