// The smoother in a basin whose truth is known, and on input that it cannot use.

#include "pingvox/slam/slam_smoother.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "pingvox/slam/odometry.hpp"
#include "slam/basin.hpp"
#include "support/rounds.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

SlamSmoother smoother_of(const Basin& basin, SlamOptions options) {
  options.body_from_sonar = pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, basin.sonar_yaw_rad);
  return SlamSmoother(std::move(options));
}

void add(SlamSmoother& smoother, const std::vector<NavSource>& sources) {
  for (const NavSource& source : sources) {
    for (const NavSample& sample : source.samples) {
      ASSERT_TRUE(smoother.add(source.name, source.quantity, sample));
    }
  }
}

Result<SlamSolution> solve(const Basin& basin, const SlamOptions& options, std::uint64_t noise_seed = 1) {
  SlamSmoother smoother = smoother_of(basin, options);
  add(smoother, basin.sources(noise_seed));
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  return smoother.solve();
}

/// Root of the mean square distance from the truth, both beginning at the same pose.
double error_m(const Trajectory& trajectory) {
  const auto start = Basin::at(trajectory.poses().front().time_s);
  double sum = 0.0;
  for (const StampedPose& pose : trajectory.poses()) {
    const Eigen::Vector2d moved = Basin::at(pose.time_s).place - start.place;
    sum += (pose.map_from_body.translation().head<2>() - moved).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(trajectory.poses().size()));
}

TEST(SlamSmoother, FindsTrajectoryAndCalibrationOfABasin) {
  const Basin basin;
  SlamOptions alone;
  alone.matching = Matching::kNone;
  const auto reckoned = solve(basin, alone), solved = solve(basin, {});
  ASSERT_TRUE(reckoned) << reckoned.error().message;
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_GT(error_m(reckoned->trajectory), 1.0);
  EXPECT_LT(error_m(solved->trajectory), 0.4);
  EXPECT_NEAR(solved->calibration.velocity_yaw_rad.value, 0.05, 0.015);
  ASSERT_EQ(solved->calibration.headings.size(), 1U);
  EXPECT_NEAR(solved->calibration.headings[0].cos1_rad.value, 0.06, 0.01);
  EXPECT_NEAR(solved->calibration.wall_in_echo.value, 0.0, 0.2);
  EXPECT_EQ(solved->report.sweeps, 80U);
  EXPECT_GT(solved->report.pairs, 5000U);
  EXPECT_GT(solved->report.loops_kept, 0U);
}

TEST(SlamSmoother, GivesAPoseForEachBeamAtItsDepth) {
  const auto solved = solve({.duration_s = 200.0}, {});
  ASSERT_TRUE(solved);
  const auto& poses = solved->trajectory.poses();
  EXPECT_EQ(poses.size(), 2000U);
  EXPECT_EQ(poses.front().map_from_body.translation().head<2>().norm(), 0.0);
  EXPECT_NEAR(poses[1000].map_from_body.translation().z(), -2.0, 1e-12);
  const Eigen::Vector3d ahead = poses[1000].map_from_body.rotation().col(0);
  EXPECT_NEAR(std::remainder(std::atan2(ahead.y(), ahead.x()) - Basin::at(poses[1000].time_s).yaw_rad, 6.283185307),
              0.0, 0.04);
}

TEST(SlamSmoother, GivesTheSameBytesForTheSameSeed) {
  const Basin basin{.duration_s = 200.0};
  const auto one = solve(basin, {}), same = solve(basin, {});
  ASSERT_TRUE(one && same);
  for (std::size_t i = 0; i < one->trajectory.poses().size(); ++i) {
    ASSERT_EQ(one->trajectory.poses()[i].map_from_body.matrix(), same->trajectory.poses()[i].map_from_body.matrix());
  }
}

TEST(SlamSmoother, SharesTheConstantOfTwoHeadings) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin;
  std::vector<NavSource> sources = basin.sources();
  NavSource other = sources[1];
  other.name = "other";
  for (NavSample& sample : other.samples) sample.value.x() += 0.04;
  sources.push_back(other);
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  const auto& headings = solved->calibration.headings;
  ASSERT_EQ(headings.size(), 2U);
  EXPECT_NEAR(headings[0].constant_rad.value, -0.02, 0.005);
  EXPECT_NEAR(headings[1].constant_rad.value, 0.02, 0.005);
}

TEST(SlamSmoother, TakesAHeadingFromAnyZeroAsOneOfTurns) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin;
  std::vector<NavSource> sources = basin.sources();
  NavSource other = sources[1];
  other.name = "gyro";
  for (NavSample& sample : other.samples) sample.value.x() += 2.0;
  sources.push_back(other);
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_LT(error_m(solved->trajectory), 0.4);
  EXPECT_NEAR(solved->calibration.headings[1].constant_rad.value, 2.0, 0.01);
}

TEST(SlamSmoother, BridgesALostBottomLock) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin;
  std::vector<NavSource> sources = basin.sources();
  for (NavSample& sample : sources[0].samples) {
    if (sample.time_s > 500.0 && sample.time_s < 520.0) sample.valid = false;
  }
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_NEAR(solved->report.longest_gap_s, 20.5, 1.0);
  EXPECT_LT(error_m(solved->trajectory), 0.5);
}

TEST(SlamSmoother, NavigationOnALateClockIsMovedByTheOffset) {
  const Basin basin{.duration_s = 400.0};
  std::vector<NavSource> sources = basin.sources();
  for (NavSource& source : sources) {
    for (NavSample& sample : source.samples) sample.time_s += 1e9;
  }
  SlamOptions options;
  options.nav_offset_s = -1e9;
  SlamSmoother smoother = smoother_of(basin, options);
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_LT(error_m(solved->trajectory), 0.4);
}

// Kills a use of what came later: beams, or navigation.
TEST(SlamSmoother, CausalPosesAreThoseOfALogThatEndsSooner) {
  SlamOptions causal;
  causal.estimation = Estimation::kCausal;
  // 100 s are solved after ten sweeps, with navigation for another second alone.
  const auto whole = solve({.duration_s = 200.0}, causal), part = solve({.duration_s = 101.0}, causal);
  ASSERT_TRUE(whole && part);
  const auto &poses = whole->trajectory.poses(), &sooner = part->trajectory.poses();
  EXPECT_EQ(poses.size(), 2000U);
  ASSERT_GT(sooner.size(), 1000U);
  for (std::size_t i = 0; i < 990; ++i) {
    ASSERT_EQ(poses[i].map_from_body.matrix(), sooner[i].map_from_body.matrix()) << i;
  }
}

TEST(SlamSmoother, CausalPosesAreBetterThanDeadReckoning) {
  SlamOptions alone, causal;
  alone.matching = Matching::kNone;
  causal.estimation = Estimation::kCausal;
  const Basin basin{.duration_s = 500.0};
  const auto reckoned = solve(basin, alone), solved = solve(basin, causal);
  ASSERT_TRUE(reckoned && solved);
  EXPECT_LT(error_m(solved->trajectory), 0.7 * error_m(reckoned->trajectory));
  EXPECT_GT(solved->report.loops_kept, 0U);
}

// Kills a calibration that is not used, or used with the wrong sign: another drive of the same sensors, without pairs.
TEST(SlamSmoother, CalibrationOfOneDriveMakesDeadReckoningOfAnotherBetter) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 400.0};
  const auto solved = solve(basin, {});
  ASSERT_TRUE(solved) << solved.error().message;
  SlamOptions alone;
  alone.matching = Matching::kNone;
  const auto reckoned = solve(basin, alone, 2);
  alone.calibration = solved->calibration;
  const auto calibrated = solve(basin, alone, 2);
  const auto odometry = odometry_of(*NavLog::make(basin.sources(2), NavClock::kUnknown),
                                    {.body_from_source = {}, .offset_s = 0.0, .calibration = solved->calibration});
  ASSERT_TRUE(reckoned && calibrated && odometry);
  EXPECT_LT(error_m(calibrated->trajectory), 0.5 * error_m(reckoned->trajectory));
  EXPECT_LT(error_m(odometry->odometry_from_body), 0.5 * error_m(reckoned->trajectory));
}

TEST(SlamSmoother, BelievesACalibrationAsFarAsItsDeviations) {
  const Basin basin{.duration_s = 60.0};
  SlamOptions options;
  options.calibration = SlamCalibration{"dvl", {0.3, 1e-6}, {0.01, 1e-6}, {0.0, 0.5}, {0.0, 0.3}, {0.0, 0.3}, {}};
  const auto solved = solve(basin, options);
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_NEAR(solved->calibration.velocity_yaw_rad.value, 0.3, 1e-4);
  EXPECT_NEAR(solved->calibration.velocity_scale.value, 0.01, 1e-4);
  EXPECT_EQ(solved->calibration.velocity, "dvl");
  options.calibration->velocity = "A50";
  const auto refused = solve(basin, options);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("A50, not of dvl"));
}

// What it cannot use.

void expect_refused(const SlamSmoother& smoother, const char* reason) {
  const auto solved = smoother.solve();
  ASSERT_FALSE(solved);
  EXPECT_THAT(solved.error().message, HasSubstr(reason));
}

TEST(SlamSmoother, RefusesToGuessWithoutBeamsVelocityOrHeading) {
  const Basin basin;
  const auto sources = basin.sources();
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  expect_refused(smoother, "no beams");

  SlamSmoother blind = smoother_of(basin, {});
  for (const Beam& beam : basin.beams()) blind.add(beam);
  expect_refused(blind, "no valid velocity and no heading");
  add(blind, {sources[0]});
  expect_refused(blind, "no valid heading");
  SlamSmoother still = smoother_of(basin, {});
  for (const Beam& beam : basin.beams()) still.add(beam);
  add(still, {sources[1]});
  expect_refused(still, "no valid velocity over ground");
}

TEST(SlamSmoother, RefusesNavigationOfAnotherTime) {
  const Basin basin;
  std::vector<NavSource> sources = basin.sources();
  for (NavSource& source : sources) {
    for (NavSample& sample : source.samples) sample.time_s += 10'000.0;
  }
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  expect_refused(smoother, "do not overlap in time");
}

TEST(SlamSmoother, RefusesNumbersThatAreNotFinite) {
  SlamSmoother smoother = smoother_of(Basin(), {});
  NavSample sample;
  sample.value.x() = std::numeric_limits<double>::quiet_NaN();
  const auto added = smoother.add("dvl", NavQuantity::kVelocity, sample);
  ASSERT_FALSE(added);
  EXPECT_THAT(added.error().message, HasSubstr("dvl"));
}

TEST(SlamSmoother, RefusesBeamsThatGoBackInTime) {
  const Basin basin;
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, basin.sources());
  std::vector<Beam> beams = basin.beams();
  beams[700].time_s = 3.0;
  for (const Beam& beam : beams) smoother.add(beam);
  expect_refused(smoother, "beam 699");
}

TEST(SlamSmoother, RefusesBeamsThatJumpInTime) {
  const Basin basin;
  SlamSmoother smoother = smoother_of(basin, {});
  std::vector<Beam> beams = basin.beams();
  beams.resize(400);
  beams.back().time_s = 1e9;
  for (const Beam& beam : beams) smoother.add(beam);
  std::vector<NavSource> sources = basin.sources();
  for (NavSource& source : sources) {
    source.samples.push_back(source.samples.back());
    source.samples.back().time_s = 2e9;
  }
  add(smoother, sources);
  expect_refused(smoother, "times jump");
}

TEST(SlamSmoother, RefusesToMatchOneSweepAlone) {
  const Basin basin;
  std::vector<Beam> beams = basin.beams();
  beams.resize(100);
  for (const Matching matching : {Matching::kPairs, Matching::kNone}) {
    SlamOptions options;
    options.matching = matching;
    SlamSmoother smoother = smoother_of(basin, options);
    add(smoother, basin.sources());
    for (const Beam& beam : beams) smoother.add(beam);
    if (matching == Matching::kPairs) {
      expect_refused(smoother, "one sweep");
    } else {
      EXPECT_TRUE(smoother.solve());
    }
  }
}

TEST(SlamSmoother, NeedsNoEchoToReckon) {
  const Basin basin;
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, basin.sources());
  for (Beam beam : basin.beams()) {
    std::ranges::fill(beam.intensities, std::uint8_t{0});
    smoother.add(std::move(beam));
  }
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_EQ(solved->report.pairs, 0U);
}

}  // namespace
}  // namespace pingvox::test
