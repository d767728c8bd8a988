// What the sonar puts into the gaps of a velocity, in a basin whose truth is known.

#include "slam/odometry/velocity_gaps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "slam/heard_basin.hpp"

namespace pingvox::test {
namespace {

constexpr double kGapFrom_s = 80.0, kGapTo_s = 140.0;

/// A drive whose velocity is missing for a minute.
class VelocityGaps : public testing::Test {
 protected:
  static VelocitySource velocity_without(double from_s, double to_s) {
    NavSource source = Basin{.duration_s = 200.0, .velocity_yaw_rad = 0.0}.sources()[0];
    std::erase_if(source.samples, [&](const NavSample& s) { return s.time_s > from_s && s.time_s < to_s; });
    return *velocity_source(source, Pose::Identity());
  }

  /// @return for how long the sonar tells it [s]
  double fill(VelocitySource& velocity, const TimeSpan& span = {50.0, 50.0}) const {
    double sum_s = 0.0;
    for (const TimeSpan& gap : fill_velocity_gaps(sweeps_, span, mount_of(basin_), heading_, velocity)) {
      sum_s += gap.to_s - gap.from_s;
    }
    return sum_s;
  }

  Basin basin_{.duration_s = 200.0, .compass_cos = 0.0};
  HeadingSource heading_ = heading_of(basin_);
  std::vector<SweepEchoes> sweeps_ = sweeps_of(basin_);
  VelocitySource velocity_ = velocity_without(kGapFrom_s, kGapTo_s);
};

// Kills a velocity that is interpolated where the sonar measures how it changes, and one weighted as that of a DVL.
TEST_F(VelocityGaps, AreFilledWithWhatTheSonarSees) {
  const VelocitySource before = velocity_;
  EXPECT_NEAR(fill(velocity_), kGapTo_s - kGapFrom_s, 1.0);
  EXPECT_EQ(velocity_.ahead.gap_s(0.0, 200.0), 0.0);
  double squares = 0.0;
  int times = 0;
  for (double time_s = kGapFrom_s; time_s <= kGapTo_s; time_s += 0.5, ++times) {
    const Eigen::Vector2d filled(velocity_.ahead.at(time_s), velocity_.left.at(time_s));
    squares += (filled - body_velocity_at(time_s)).squaredNorm();
  }
  EXPECT_LT(std::sqrt(squares / times), 0.06);
  EXPECT_GT(velocity_.density.at(110.0), 2.0 * before.density.at(50.0));
  for (const double time_s : before.ahead.times_s()) {
    EXPECT_EQ(velocity_.ahead.at(time_s), before.ahead.at(time_s)) << time_s;
    EXPECT_EQ(velocity_.density.at(time_s), before.density.at(time_s)) << time_s;
  }
}

// Kills a motion that is taken to be even over sweeps in which the vehicle may have stopped.
TEST_F(VelocityGaps, StayWhereSweepsDoNotMatch) {
  for (SweepEchoes& sweep : sweeps_) {
    if (sweep.from_s > 105.0 && sweep.from_s < 125.0) sweep.runs.clear();
  }
  const double filled_s = fill(velocity_);
  EXPECT_GT(filled_s, 10.0);
  EXPECT_LT(filled_s, 35.0);
  EXPECT_NEAR(velocity_.ahead.gap_s(0.0, 200.0), kGapTo_s - kGapFrom_s - filled_s, 2.0);
  EXPECT_EQ(velocity_.ahead.gap_s(112.0, 125.0), 13.0);
}

TEST_F(VelocityGaps, StayWhereTheSonarTellsNothing) {
  const std::vector<double> times_s = velocity_.ahead.times_s();
  for (SweepEchoes& sweep : sweeps_) sweep.runs.clear();
  EXPECT_EQ(fill(velocity_), 0.0);
  EXPECT_EQ(velocity_.ahead.times_s(), times_s);
  VelocitySource shorter = velocity_without(80.0, 88.0);
  sweeps_ = sweeps_of(basin_);
  EXPECT_EQ(fill(shorter), 0.0) << "shorter than a sweep, in which the sonar tells nothing";
}

// Kills a velocity that ends where the sensor fails, and one that is made up where nobody knows how the vehicle turned.
TEST_F(VelocityGaps, AreFilledBeforeAndAfterTheMeasuredVelocity) {
  VelocitySource velocity = velocity_without(120.0, 201.0);
  EXPECT_EQ(fill(velocity, {0.0, 120.0}), 0.0);
  EXPECT_NEAR(fill(velocity, {0.0, 200.0}), 70.0, 1.0) << "until the middle between the last two sweeps";
  EXPECT_NEAR(velocity.ahead.to_s(), 190.0, 1.0);
  EXPECT_EQ(velocity.ahead.gap_s(0.0, 189.0), 0.0);

  VelocitySource late = velocity_without(-1.0, 60.0);
  EXPECT_NEAR(fill(late, {0.0, 200.0}), 50.0, 1.0);
  EXPECT_NEAR(late.ahead.from_s(), 10.0, 1.0);

  std::vector<double> times_s, yaws_rad;
  for (double time_s = 0.0; time_s < 165.0; time_s += 1.0) {
    times_s.push_back(time_s);
    yaws_rad.push_back(heading_.yaw_rad.at(time_s));
  }
  heading_.yaw_rad = TimeSeries(times_s, yaws_rad);
  VelocitySource until_heading = velocity_without(120.0, 201.0);
  EXPECT_GT(fill(until_heading, {0.0, 200.0}), 30.0);
  EXPECT_LT(until_heading.ahead.to_s(), times_s.back());
}

// Kills samples without end: a clock whose steps are of no length.
TEST_F(VelocityGaps, TakeFewSamples) {
  std::vector<double> times_s, values;
  for (int i = 0; i < 100; ++i) times_s.push_back(20.0 + 1e-9 * i);
  times_s.push_back(180.0);
  values.assign(times_s.size(), 0.1);
  velocity_.ahead = velocity_.left = velocity_.density = TimeSeries(times_s, values);
  EXPECT_GT(fill(velocity_), 100.0);
  EXPECT_LT(velocity_.ahead.size(), 1000U);
}

// Kills four samples a second of a sonar whose times are in other units.
TEST_F(VelocityGaps, TakeFewSamplesOfSlowSweeps) {
  constexpr double kSlower = 1e6;
  for (SweepEchoes& sweep : sweeps_) {
    sweep.from_s *= kSlower;
    sweep.to_s *= kSlower;
    for (EchoRun& run : sweep.runs) run.time_s *= kSlower;
  }
  velocity_.ahead = velocity_.left = velocity_.density = TimeSeries({20e6, 20e6 + 1.0, 180e6}, {0.0, 0.0, 0.0});
  heading_.yaw_rad = TimeSeries({0.0, 200e6}, {0.0, 0.0});
  fill(velocity_);
  EXPECT_LT(velocity_.ahead.size(), 4000U);
}

}  // namespace
}  // namespace pingvox::test
