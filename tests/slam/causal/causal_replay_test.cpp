// What CausalSlam would have told of a recording, in a basin whose truth is known.

#include "pingvox/slam/causal_replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "slam/smoother_in_basin.hpp"
#include "support/rounds.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

// Kills a use of what came later: beams, or navigation.
TEST(CausalReplay, PosesAreThoseOfALogThatEndsSooner) {
  // 100 s are solved after ten sweeps, with navigation for another second alone.
  const auto whole = solve<CausalReplay>({.duration_s = 200.0}, {}),
             part = solve<CausalReplay>({.duration_s = 101.0}, {});
  ASSERT_TRUE(whole && part);
  const auto &poses = whole->trajectory.poses(), &sooner = part->trajectory.poses();
  EXPECT_EQ(poses.size(), 2000U);
  ASSERT_GT(sooner.size(), 1000U);
  for (std::size_t i = 0; i < 990; ++i) {
    ASSERT_EQ(poses[i].map_from_body.matrix(), sooner[i].map_from_body.matrix()) << i;
  }
}

TEST(CausalReplay, PosesAreBetterThanDeadReckoning) {
  SlamOptions alone;
  alone.matching = Matching::kNone;
  const Basin basin{.duration_s = 500.0};
  const auto reckoned = solve(basin, alone), solved = solve<CausalReplay>(basin, {});
  ASSERT_TRUE(reckoned && solved);
  EXPECT_LT(error_m(solved->trajectory), 0.7 * error_m(reckoned->trajectory));
  EXPECT_GT(solved->report.pairs.loops.kept, 0U);
}

// Kills a window that does not move, sweeps that all stay partners, and numbers that are told of the window alone.
TEST(CausalReplay, WorkDoesNotGrowWithTheLog) {
  SlamOptions causal;
  causal.causal_sweeps = 8;
  constexpr std::size_t kKnots = 9 * (8 + 2) / 2 + 1;  // nine in two sweeps
  for (const double duration_s : {200.0, 400.0}) {
    SCOPED_TRACE(duration_s);
    const auto solved = solve<CausalReplay>({.duration_s = duration_s}, causal);
    ASSERT_TRUE(solved) << solved.error().message;
    const SlamReport& report = solved->report;
    ASSERT_TRUE(report.largest);
    EXPECT_LE(report.largest->knots, kKnots);
    // Ten sweeps of a hundred beams; eight partners before them, and ten for each that is far enough in time.
    EXPECT_LE(report.largest->echoes, 100U * (10 + 8 + 10 * 10));
    EXPECT_LE(report.largest->pairs, 1000U * (5 + 5 + 10));
    EXPECT_GT(report.largest->pairs, 1000U);
    EXPECT_NEAR(static_cast<double>(report.knots), 9.0 * duration_s / 20.0, 2.0);
    EXPECT_GT(static_cast<double>(report.echoes), 9.0 * duration_s);
    EXPECT_EQ(solved->trajectory.poses().size(), static_cast<std::size_t>(10.0 * duration_s));
  }
}

// Kills sweeps that are forgotten when they leave, a prior that is dropped, and one that is taken where it is not: the
// second lap goes where the first one did.
TEST(CausalReplay, TheWindowComesBackToWhatLeftIt) {
  SlamOptions alone, causal;
  alone.matching = Matching::kNone;
  causal.causal_sweeps = 8;  // all of them too near in time to be a loop
  const Basin basin{.duration_s = 600.0};
  const auto reckoned = solve(basin, alone), solved = solve<CausalReplay>(basin, causal);
  ASSERT_TRUE(reckoned && solved);
  EXPECT_LT(error_m(solved->trajectory), 0.7 * error_m(reckoned->trajectory));
  EXPECT_GT(solved->report.pairs.loops.kept, 0U);
  EXPECT_NEAR(solved->calibration.velocity_yaw_rad.value, basin.velocity_yaw_rad, 0.02);
}

// Kills loops that are looked for in the window alone or do not move it: it drifts away from what left by 8 m, beyond
// any pair, while the sonar hears nothing.
TEST(CausalReplay, PosesComeBackFromBeyondTheReachOfPairs) {
  SlamOptions causal;
  causal.causal_sweeps = 24;
  const Basin basin{.duration_s = 600.0, .velocity_noise_m_s = 0.2};
  const auto is_silent = [](double time_s) { return time_s >= 200.0 && time_s < 400.0; };
  std::vector<NavSource> sources = basin.sources();
  for (NavSample& sample : sources[0].samples) {
    const double yaw_rad = Basin::at(sample.time_s).yaw_rad;
    if (is_silent(sample.time_s)) sample.value += 0.04 * Eigen::Vector3d(std::cos(yaw_rad), -std::sin(yaw_rad), 0.0);
  }
  CausalReplay smoother = smoother_of<CausalReplay>(basin, causal);
  add(smoother, sources);
  for (Beam beam : basin.beams()) {
    if (is_silent(beam.time_s)) std::ranges::fill(beam.intensities, std::uint8_t{0});
    smoother.add(std::move(beam));
  }
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  const auto off_m = [&](double time_s) {
    const Eigen::Vector2d moved = Basin::at(time_s).place - Basin::at(0.0).place;
    return (solved->trajectory.at(time_s)->translation().head<2>() - moved).norm();
  };
  EXPECT_GT(off_m(405.0), 5.0);
  for (double time_s = 500.0; time_s < 600.0; time_s += 10.0) EXPECT_LT(off_m(time_s), 3.0) << time_s;
  EXPECT_GT(solved->report.pairs.submap_loops.kept, 0U);
}

// Kills odometry by the sonar that forgets, jumps or is taken twice where it goes on, and that of later sweeps.
TEST(CausalReplay, FindsTheWayWithoutVelocity) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 400.0, .compass_cos = 0.02};
  SlamOptions causal;
  causal.causal_sweeps = 12;
  const auto solved = solve_without_velocity<CausalReplay>(basin, causal, basin.sources()[1]);
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_LT(error_m(solved->trajectory), 1.0);
  EXPECT_EQ(solved->trajectory.poses().size(), 4000U);
  ASSERT_TRUE(solved->report.velocity.by_sonar);
  EXPECT_GT(solved->report.velocity.by_sonar->matched, 36U);
  EXPECT_LE(solved->report.velocity.by_sonar->matched, 39U);
  const auto sooner =
      solve_without_velocity<CausalReplay>({.duration_s = 301.0, .compass_cos = 0.02}, causal, basin.sources()[1]);
  ASSERT_TRUE(sooner);
  for (std::size_t i = 0; i < 2990; ++i) {
    ASSERT_EQ(solved->trajectory.poses()[i].map_from_body.matrix(),
              sooner->trajectory.poses()[i].map_from_body.matrix());
  }
}

TEST(CausalReplay, FindsTheWayByTheSonarAlone) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 300.0};
  const auto solved = solve<CausalReplay>(basin, {}, std::vector<NavSource>{});
  ASSERT_TRUE(solved) << solved.error().message;
  const auto& poses = solved->trajectory.poses();
  EXPECT_NEAR((poses.back().map_from_body.translation() - poses.front().map_from_body.translation()).norm(),
              (Basin::at(poses.back().time_s).place - Basin::at(poses.front().time_s).place).norm(), 2.0);
}

// Kills turns that are made up where the clock of the navigation jumps ahead.
TEST(CausalReplay, RefusesBeamsWhereNoHeadingIsKnown) {
  const Basin basin{.duration_s = 200.0};
  const auto solved = solve<CausalReplay>(basin, {}, with_jump_of_the_clock(basin.sources()));
  ASSERT_FALSE(solved);
  EXPECT_THAT(solved.error().message,
              HasSubstr("no heading is known from 100.000 to 3700.200 s, where there are 1000 beams"));
}

// Kills a solution without any step, whose calibration has no deviations.
TEST(CausalReplay, ReckonsAlongOneSweepAlone) {
  const auto solved = solve<CausalReplay>({.duration_s = 10.0}, {});
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_EQ(solved->report.pairs.count, 0U);
  EXPECT_FALSE(solved->report.velocity.check);
  EXPECT_GT(solved->calibration.velocity_yaw_rad.deviation, 0.0);
  EXPECT_LT(error_m(solved->trajectory), 0.5);
  EXPECT_TRUE(solved->covariances.empty());
}

TEST(CausalReplay, RefusesVelocitiesThatNoVehicleHas) {
  const Basin basin{.duration_s = 60.0};
  for (const double velocity_m_s : {40.0, 1e6, 1e300}) {
    const auto solved = solve<CausalReplay>(basin, {}, with_velocity_ahead(velocity_m_s, basin.sources()));
    ASSERT_FALSE(solved);
    EXPECT_THAT(solved.error().message, HasSubstr(velocity_m_s > 100.0 ? "is beyond 100 m/s" : "m/s most of the time"));
  }
}

TEST(CausalReplay, SaysThatTheSonarContradictsTheVelocity) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 200.0};
  std::vector<NavSource> sources = basin.sources(1);
  for (NavSample& sample : sources[0].samples) sample.value *= 1e-3;
  const auto solved = solve<CausalReplay>(basin, {}, sources);
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_THAT(solved->report.implausible, testing::Contains(testing::StartsWith("velocity of dvl (")));
}

}  // namespace
}  // namespace pingvox::test
