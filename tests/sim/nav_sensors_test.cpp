#include "pingvox/sim/nav_sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/sim/vehicle.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

/// Without any error.
NavSensorOptions perfect() {
  NavSensorOptions options;
  options.dvl_noise_m_s = options.dvl_outliers = options.dvl_lost = options.dvl_yaw_rad = options.dvl_scale = 0.0;
  options.attitude_noise_rad = options.compass_deviation_rad = options.gyro_noise_rad_s = 0.0;
  options.gyro_drift_rad_s = options.depth_noise_m = options.delay_s = 0.0;
  return options;
}

const NavSource& source(const SimulatedNav& nav, NavQuantity quantity) {
  const NavSource* found = nav.log.best(quantity);
  EXPECT_NE(found, nullptr) << name_of(quantity);
  return *found;
}

/// A circle of 10 m to the left at 0.5 m/s, 2 m below z = 0: a turn of 0.05 rad/s.
Trajectory circle(double duration_s) {
  std::vector<StampedPose> poses;
  for (double t = 0.0; t <= duration_s + 0.05; t += 0.05) {
    const double yaw = 0.05 * t;
    poses.push_back({t, pose_from_rpy({10.0 * std::sin(yaw), -10.0 * std::cos(yaw), -2.0}, 0.0, 0.0, yaw)});
  }
  return *Trajectory::make(std::move(poses));
}

TEST(NavSensors, SayTheTruthWhereTheyHaveNoErrors) {
  const SimulatedNav nav = simulate_nav(circle(120.0), 0.0, 120.0, perfect());
  const NavSource& dvl = source(nav, NavQuantity::kVelocity);
  EXPECT_EQ(dvl.samples.size(), 361U) << "three a second";
  for (const NavSample& s : dvl.samples) {
    EXPECT_TRUE(s.valid);
    EXPECT_NEAR((s.value - Vector3d(0.5, 0.0, 0.0)).norm(), 0.0, 2e-3) << "ahead, in the body frame";
  }
  for (const NavSample& s : source(nav, NavQuantity::kAttitude).samples) {
    EXPECT_NEAR(std::remainder(s.value.z() - 0.05 * s.time_s, 2.0 * std::numbers::pi), 0.0, 1e-4);
    EXPECT_NEAR(s.value.head<2>().norm(), 0.0, 1e-4);
  }
  for (const NavSample& s : source(nav, NavQuantity::kTurnRate).samples) {
    EXPECT_NEAR((s.value - Vector3d(0.0, 0.0, 0.05)).norm(), 0.0, 1e-4);
  }
  for (const NavSample& s : source(nav, NavQuantity::kDepth).samples) EXPECT_NEAR(s.value.x(), 2.0, 1e-3);
}

TEST(NavSensors, AttitudeOfATiltedVehicleIsFixedAxisRollPitchYaw) {
  const Pose tilted = pose_from_rpy(Vector3d::Zero(), 0.1, -0.2, 2.5);
  const SimulatedNav nav = simulate_nav(Trajectory::still(tilted), 0.0, 1.0, perfect());
  const NavSample& sample = source(nav, NavQuantity::kAttitude).samples.front();
  EXPECT_NEAR((sample.value - Vector3d(0.1, -0.2, 2.5)).norm(), 0.0, 1e-4);
}

TEST(NavSensors, ConstantErrorsAreThoseThatAreReported) {
  NavSensorOptions options = perfect();
  options.seed = 7;
  options.dvl_yaw_rad = 4.0 * kDegree_rad;
  options.dvl_scale = 0.02;
  options.compass_deviation_rad = 5.0 * kDegree_rad;
  const auto [log, errors] = simulate_nav(circle(130.0), 0.0, 130.0, options);
  EXPECT_GT(std::abs(errors.dvl_yaw_rad), 0.1 * kDegree_rad);
  EXPECT_GT(std::abs(errors.dvl_scale), 1e-4);
  for (const NavSample& s : log.best(NavQuantity::kVelocity)->samples) {
    // A DVL that is turned to the left sees what is ahead to its right.
    EXPECT_NEAR(std::atan2(s.value.y(), s.value.x()), -errors.dvl_yaw_rad, 5e-3);
    EXPECT_NEAR(s.value.norm() * (1.0 + errors.dvl_scale), 0.5, 2e-3);
  }
  for (const NavSample& s : log.best(NavQuantity::kAttitude)->samples) {
    const double yaw = 0.05 * s.time_s;
    const double deviation = errors.constant_rad + errors.sin1_rad * std::sin(yaw) + errors.cos1_rad * std::cos(yaw) +
                             errors.sin2_rad * std::sin(2.0 * yaw) + errors.cos2_rad * std::cos(2.0 * yaw);
    EXPECT_NEAR(std::remainder(s.value.z() - yaw - deviation, 2.0 * std::numbers::pi), 0.0, 1e-4);
  }
}

TEST(NavSensors, ConstantErrorsHaveTheDeviationOrdered) {
  NavSensorOptions options = perfect();
  options.dvl_yaw_rad = 0.1;
  options.dvl_scale = 0.01;
  options.compass_deviation_rad = 0.1;
  options.gyro_drift_rad_s = 0.01;
  constexpr int kSeeds = 400;
  Eigen::Array<double, 6, 1> squares = Eigen::Array<double, 6, 1>::Zero();
  for (int seed = 0; seed < kSeeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    const NavSensorErrors e = simulate_nav(Trajectory::still(Pose::Identity()), 0.0, 0.1, options).errors;
    const Eigen::Array<double, 6, 1> errors = {e.dvl_yaw_rad / 0.1,    e.dvl_scale / 0.01,
                                               e.sin1_rad / 0.1,       e.cos1_rad / 0.1,
                                               3.0 * e.cos2_rad / 0.1, e.gyro_bias_start_rad_s / 0.01};
    squares += errors.square() / kSeeds;
  }
  // Deviations of 400 are known to 3.5 %: four of these.
  for (const double square : squares) EXPECT_NEAR(std::sqrt(square), 1.0, 0.14);
}

TEST(NavSensors, NoiseOutliersAndLostBottomLockAreAsOftenAsOrdered) {
  NavSensorOptions options = perfect();
  options.dvl_noise_m_s = 0.05;
  options.dvl_outliers = 0.1;
  options.dvl_lost = 0.2;
  const SimulatedNav nav = simulate_nav(Trajectory::still(Pose::Identity()), 0.0, 20'000.0, options);
  const NavSource& dvl = source(nav, NavQuantity::kVelocity);
  double lost = 0.0, times_lost = 0.0, wrong = 0.0, squares = 0.0, usual = 0.0;
  for (std::size_t n = 0; n < dvl.samples.size(); ++n) {
    const NavSample& s = dvl.samples[n];
    lost += s.valid ? 0.0 : 1.0;
    if (!s.valid) {
      times_lost += n == 0 || dvl.samples[n - 1].valid ? 1.0 : 0.0;
    } else if (s.value.norm() > 0.3) {
      wrong += 1.0;
    } else {
      usual += 1.0;
      squares += s.value.x() * s.value.x();
    }
  }
  const auto all = static_cast<double>(dvl.samples.size());
  EXPECT_NEAR(lost / all, 0.2, 0.03);
  EXPECT_NEAR(lost / times_lost / options.dvl_per_s, 5.0, 0.7) << "seconds";
  EXPECT_NEAR(wrong / (wrong + usual), 0.1, 0.01);
  EXPECT_NEAR(std::sqrt(squares / usual), 0.05, 0.004);
}

TEST(NavSensors, ALateClockMovesTimesAndNothingElse) {
  NavSensorOptions options;
  options.delay_s = 0.0;
  const SimulatedNav now = simulate_nav(circle(30.0), 0.0, 30.0, options);
  options.delay_s = 0.25;
  const SimulatedNav late = simulate_nav(circle(30.0), 0.0, 30.0, options);
  ASSERT_EQ(now.log.sources().size(), 4U);
  for (std::size_t i = 0; i < now.log.sources().size(); ++i) {
    const auto &a = now.log.sources()[i].samples, &b = late.log.sources()[i].samples;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t n = 0; n < a.size(); ++n) {
      EXPECT_NEAR(b[n].time_s, a[n].time_s + 0.25, 1e-4);
      EXPECT_EQ(b[n].value, a[n].value);
    }
  }
}

TEST(NavSensors, GyrosDriftFromOneBiasToTheOther) {
  NavSensorOptions options = perfect();
  options.gyro_drift_rad_s = 0.01;
  const auto [log, errors] = simulate_nav(Trajectory::still(Pose::Identity()), 0.0, 600.0, options);
  const std::vector<NavSample>& samples = log.best(NavQuantity::kTurnRate)->samples;
  EXPECT_NEAR(samples.front().value.z(), errors.gyro_bias_start_rad_s, 1e-5);
  EXPECT_NEAR(samples.back().value.z(), errors.gyro_bias_end_rad_s, 1e-5);
  EXPECT_NE(errors.gyro_bias_start_rad_s, errors.gyro_bias_end_rad_s);
}

TEST(NavSensors, SayNothingWhereTheTrajectoryHasAGap) {
  std::vector<StampedPose> poses;
  for (const double t : {0.0, 1.0, 2.0, 12.0, 13.0}) poses.push_back({t, Pose(Eigen::Translation3d(t, 0.0, 0.0))});
  const SimulatedNav nav = simulate_nav(*Trajectory::make(poses, 5.0), 0.0, 13.0, perfect());
  const NavSource& dvl = source(nav, NavQuantity::kVelocity);
  for (const NavSample& s : dvl.samples) {
    EXPECT_TRUE(s.time_s <= 2.0 || s.time_s >= 12.0) << s.time_s;
    EXPECT_NEAR(s.value.x(), 1.0, 1e-3) << s.time_s;
  }
  EXPECT_EQ(dvl.samples.size(), 7U + 4U);
}

TEST(NavSensors, OptionsOfOneSensorDoNotChangeTheNoiseOfAnother) {
  NavSensorOptions options;
  const SimulatedNav once = simulate_nav(circle(30.0), 0.0, 30.0, options);
  options.dvl_per_s = 7.0;
  options.dvl_lost = 0.5;
  const SimulatedNav again = simulate_nav(circle(30.0), 0.0, 30.0, options);
  const auto &a = source(once, NavQuantity::kDepth).samples, &b = source(again, NavQuantity::kDepth).samples;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n) EXPECT_EQ(a[n].value, b[n].value);
}

TEST(Options, OfNavSensorsNameEveryBrokenField) {
  EXPECT_TRUE(NavSensorOptions{}.validate());
  NavSensorOptions bad;
  bad.dvl_per_s = bad.attitude_per_s = bad.depth_per_s = 0.0;
  bad.dvl_noise_m_s = bad.dvl_outliers = bad.dvl_yaw_rad = bad.dvl_scale = bad.attitude_noise_rad = -1.0;
  bad.compass_deviation_rad = bad.gyro_noise_rad_s = bad.gyro_drift_rad_s = bad.depth_noise_m = -1.0;
  bad.dvl_lost = 1.0;
  bad.delay_s = std::numeric_limits<double>::quiet_NaN();
  const std::string message = bad.validate().error().message;
  for (const char* field : {"dvl_per_s", "attitude_per_s", "depth_per_s", "dvl_noise_m_s", "dvl_outliers", "dvl_lost",
                            "dvl_yaw_rad", "dvl_scale", "attitude_noise_rad", "compass_deviation_rad",
                            "gyro_noise_rad_s", "gyro_drift_rad_s", "depth_noise_m", "delay_s"}) {
    EXPECT_NE(message.find(field), std::string::npos) << field;
  }
}

}  // namespace
}  // namespace pingvox
