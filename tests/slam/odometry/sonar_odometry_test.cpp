// How the vehicle moved by its sonar alone, in a basin whose truth is known.

#include "slam/odometry/sonar_odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "slam/heard_basin.hpp"

namespace pingvox::test {
namespace {

TEST(SonarOdometry, TellsTheVelocityInTheFrameOfTheBody) {
  const Basin basin{.duration_s = 300.0, .compass_cos = 0.0};
  const HeadingSource heading = heading_of(basin);
  const auto odometry = sonar_odometry(sweeps_of(basin), mount_of(basin), &heading);
  EXPECT_TRUE(odometry.is_observable);
  EXPECT_GT(odometry.matched, 24U);
  double sum = 0.0;
  const auto& samples = odometry.velocity.samples;
  for (const NavSample& sample : samples) {
    sum += (sample.value.head<2>() - body_velocity_at(sample.time_s)).squaredNorm();
  }
  EXPECT_LT(std::sqrt(sum / static_cast<double>(samples.size())), 0.06);
}

TEST(SonarOdometry, TellsTheTurnsWhereNoHeadingIsKnown) {
  const Basin basin{.duration_s = 150.0};
  const auto odometry = sonar_odometry(sweeps_of(basin), mount_of(basin), nullptr);
  ASSERT_TRUE(odometry.is_observable);
  const auto& samples = odometry.heading.samples;
  const double start_rad = Basin::at(samples.front().time_s).yaw_rad;
  for (const NavSample& sample : samples) {
    const double turned_rad = Basin::at(sample.time_s).yaw_rad - start_rad;
    EXPECT_NEAR(std::remainder(sample.value.x() - turned_rad, 2.0 * std::numbers::pi), 0.0, 0.2) << sample.time_s;
  }
}

// Kills a trajectory that is bent by a turn which nothing saw.
TEST(SonarOdometry, WithoutAHeadingNoTurnMayBeMissed) {
  const Basin basin{.duration_s = 200.0};
  std::vector<SweepEchoes> sweeps = sweeps_of(basin);
  ASSERT_TRUE(sonar_odometry(sweeps, mount_of(basin), nullptr).is_observable);
  EXPECT_FALSE(sonar_odometry(std::span(sweeps).first(4), mount_of(basin), nullptr).is_observable) << "too few";
  sweeps[9].runs.clear();
  EXPECT_FALSE(sonar_odometry(sweeps, mount_of(basin), nullptr).is_observable);
  const HeadingSource heading = heading_of(basin);
  EXPECT_TRUE(sonar_odometry(sweeps, mount_of(basin), &heading).is_observable);
}

// Kills a check that a wrong compass, a turned DVL or noise fails, and one that a DVL which stands still passes.
TEST(VelocityCheck, TellsAVelocityThatTheSonarContradicts) {
  const Basin basin{.duration_s = 200.0, .velocity_yaw_rad = 0.15, .velocity_noise_m_s = 0.2};
  const HeadingSource heading = heading_of(basin);
  const auto check = [&](NavSource source, double by) {
    for (NavSample& sample : source.samples) sample.value *= by;
    return check_velocity(*velocity_source(source, Pose::Identity()), sweeps_of(basin), mount_of(basin), heading);
  };
  const auto right = check(basin.sources()[0], 1.0), still = check(basin.sources()[0], 0.0);
  ASSERT_TRUE(right && still);
  EXPECT_FALSE(right->contradicts) << right->difference_m_s;
  EXPECT_TRUE(still->contradicts) << still->difference_m_s;
  EXPECT_NEAR(still->difference_m_s, Basin::velocity_at(50.0).norm(), 0.2);
}

// Kills a velocity that is told although nothing was seen.
TEST(SonarOdometry, TellsNothingWhereTheSonarSeesNothing) {
  const Basin basin{.duration_s = 200.0};
  const HeadingSource heading = heading_of(basin);
  std::vector<SweepEchoes> sweeps = sweeps_of(basin);
  for (std::size_t k = 8; k < 14; ++k) sweeps[k].runs.clear();
  const auto odometry = sonar_odometry(sweeps, mount_of(basin), &heading);
  EXPECT_TRUE(odometry.is_observable);
  for (const NavSample& sample : odometry.velocity.samples) {
    EXPECT_FALSE(sample.time_s > 80.0 && sample.time_s < 140.0) << sample.time_s;
  }
  for (SweepEchoes& sweep : sweeps) sweep.runs.clear();
  EXPECT_FALSE(sonar_odometry(sweeps, mount_of(basin), &heading).is_observable);
  EXPECT_FALSE(sonar_odometry({}, mount_of(basin), &heading).is_observable);
}

// Kills rasters as large as what a damaged log says: a time that jumps, a single far echo among near ones.
TEST(SonarOdometry, DamagedTimesAndRangesTakeNoMemory) {
  const Basin basin{.duration_s = 60.0};
  const HeadingSource heading = heading_of(basin);
  for (const HeadingSource* known : {&heading, static_cast<const HeadingSource*>(nullptr)}) {
    std::vector<SweepEchoes> late = sweeps_of(basin), near = late;
    late.back().to_s = late.back().runs.back().time_s = 1e9;
    EXPECT_LE(sonar_odometry(late, mount_of(basin), known).matched, 5U);
    for (SweepEchoes& sweep : near) {
      for (EchoRun& run : sweep.runs) run.range_m = 1e-9;
      sweep.runs.back().range_m = 1e6;
    }
    EXPECT_LE(sonar_odometry(near, mount_of(basin), known).matched, 5U);
    for (SweepEchoes& sweep : near) {
      for (EchoRun& run : sweep.runs) run.range_m = 0.0;
    }
    EXPECT_FALSE(sonar_odometry(near, mount_of(basin), known).is_observable);
  }
}

}  // namespace
}  // namespace pingvox::test
