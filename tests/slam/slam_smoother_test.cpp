// The smoother in a basin whose truth is known, and on input that it cannot use.

#include "pingvox/slam/slam_smoother.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
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

TEST(SlamSmoother, FindsLoopsOfSubmapsWhereItGoesRoundAgain) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const auto solved = solve(Basin{.duration_s = 560.0, .compass_cos = 0.3}, {});
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_LT(error_m(solved->trajectory), 0.5);
  EXPECT_GT(solved->report.submap_loops_kept, 2U);
  EXPECT_LE(solved->report.submap_loops_kept, solved->report.submap_loops_found);
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

// Kills a window that does not move, sweeps that all stay partners, and numbers that are told of the window alone.
TEST(SlamSmoother, CausalWorkDoesNotGrowWithTheLog) {
  SlamOptions causal;
  causal.estimation = Estimation::kCausal;
  causal.causal_sweeps = 8;
  constexpr std::size_t kKnots = 9 * (8 + 2) / 2 + 1;  // nine in two sweeps
  for (const double duration_s : {200.0, 400.0}) {
    SCOPED_TRACE(duration_s);
    const auto solved = solve({.duration_s = duration_s}, causal);
    ASSERT_TRUE(solved) << solved.error().message;
    const SlamReport& report = solved->report;
    EXPECT_LE(report.largest.knots, kKnots);
    // Ten sweeps of a hundred beams; eight partners before them, and ten for each that is far enough in time.
    EXPECT_LE(report.largest.echoes, 100U * (10 + 8 + 10 * 10));
    EXPECT_LE(report.largest.pairs, 1000U * (5 + 5 + 10));
    EXPECT_GT(report.largest.pairs, 1000U);
    EXPECT_NEAR(static_cast<double>(report.knots), 9.0 * duration_s / 20.0, 2.0);
    EXPECT_GT(static_cast<double>(report.echoes), 9.0 * duration_s);
    EXPECT_EQ(solved->trajectory.poses().size(), static_cast<std::size_t>(10.0 * duration_s));
  }
}

// Kills sweeps that are forgotten when they leave, a prior that is dropped, and one that is taken where it is not: the
// second lap goes where the first one did.
TEST(SlamSmoother, CausalWindowComesBackToWhatLeftIt) {
  SlamOptions alone, causal;
  alone.matching = Matching::kNone;
  causal.estimation = Estimation::kCausal;
  causal.causal_sweeps = 8;  // all of them too near in time to be a loop
  const Basin basin{.duration_s = 600.0};
  const auto reckoned = solve(basin, alone), solved = solve(basin, causal);
  ASSERT_TRUE(reckoned && solved);
  EXPECT_LT(error_m(solved->trajectory), 0.7 * error_m(reckoned->trajectory));
  EXPECT_GT(solved->report.loops_kept, 0U);
  EXPECT_NEAR(solved->calibration.velocity_yaw_rad.value, basin.velocity_yaw_rad, 0.02);
}

// Kills loops that are looked for in the window alone or do not move it: it drifts away from what left by 8 m, beyond
// any pair, while the sonar hears nothing.
TEST(SlamSmoother, CausalPosesComeBackFromBeyondTheReachOfPairs) {
  SlamOptions causal;
  causal.estimation = Estimation::kCausal;
  causal.causal_sweeps = 24;
  const Basin basin{.duration_s = 600.0, .velocity_noise_m_s = 0.2};
  const auto is_silent = [](double time_s) { return time_s >= 200.0 && time_s < 400.0; };
  std::vector<NavSource> sources = basin.sources();
  for (NavSample& sample : sources[0].samples) {
    const double yaw_rad = Basin::at(sample.time_s).yaw_rad;
    if (is_silent(sample.time_s)) sample.value += 0.04 * Eigen::Vector3d(std::cos(yaw_rad), -std::sin(yaw_rad), 0.0);
  }
  SlamSmoother smoother = smoother_of(basin, causal);
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
  EXPECT_GT(solved->report.submap_loops_kept, 0U);
}

TEST(SlamSmoother, RefusesAWindowOfNoSweep) {
  SlamOptions options;
  options.causal_sweeps = 1;
  const auto valid = options.validate();
  ASSERT_FALSE(valid);
  EXPECT_THAT(valid.error().message, HasSubstr("causal_sweeps"));
}

// Kills covariances of other unknowns, in another order, or without the pairs: they are what noise does.
TEST(SlamSmoother, CovariancesAreThoseOfTheScatterOverSeeds) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 150.0};
  constexpr Estimate kNone{0.0, 1e-4};
  SlamOptions options;
  options.calibration = SlamCalibration{"dvl",
                                        {basin.velocity_yaw_rad, 1e-4},
                                        kNone,
                                        kNone,
                                        kNone,
                                        kNone,
                                        {{"compass", kNone, kNone, {basin.compass_cos, 1e-4}, kNone, kNone}}};
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  for (const Matching matching : {Matching::kPairs, Matching::kNone}) {
    options.matching = matching;
    constexpr std::size_t kSeeds = 12;
    std::vector<Eigen::Vector2d> places;
    Eigen::Vector2d believed;
    for (std::size_t seed = 1; seed <= kSeeds; ++seed) {
      const auto solved = solve(basin, options, seed);
      ASSERT_TRUE(solved) << solved.error().message;
      const auto at =
          std::ranges::find_if(solved->covariances, [](const PoseCovariance& c) { return c.time_s > 100.0; });
      ASSERT_NE(at, solved->covariances.end());
      believed = at->covariance.diagonal().head<2>().cwiseSqrt();
      places.emplace_back(solved->trajectory.at(at->time_s)->translation().head<2>());
    }
    Eigen::Vector2d mean = Eigen::Vector2d::Zero(), squares = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& place : places) mean += place / double{kSeeds};
    for (const Eigen::Vector2d& place : places) squares += (place - mean).cwiseAbs2() / (kSeeds - 1.0);
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_LT(std::sqrt(squares[axis]), 1.5 * believed[axis]) << axis;
      EXPECT_GT(std::sqrt(squares[axis]), 0.4 * believed[axis]) << axis;
      EXPECT_GT(believed[axis], 1.5 * last[axis]) << "less is known without pairs";
    }
    last = believed;
  }
}

TEST(SlamSmoother, CovariancesBeginAtTheFirstPoseAndAreOfTheBody) {
  const Basin basin{.duration_s = 60.0};
  SlamOptions options;
  const auto at_source = solve(basin, options);
  // The body is 2 m behind the velocity's source: its place depends on the yaw.
  options.body_from_source["dvl"] = Pose(Eigen::Translation3d(2.0, 0.0, 0.0));
  options.matching = Matching::kNone;
  const auto behind = solve(basin, options);
  options.body_from_source.clear();
  const auto reckoned = solve(basin, options);
  options.estimation = Estimation::kCausal;
  const auto causal = solve(basin, options);
  ASSERT_TRUE(at_source && behind && reckoned && causal);
  EXPECT_EQ(at_source->covariances.size(), at_source->report.knots);
  EXPECT_LT(place_ellipse(at_source->covariances.front().covariance).along_m, 0.01);
  EXPECT_TRUE(causal->covariances.empty());
  const auto &of_source = reckoned->covariances.front(), &of_body = behind->covariances.front();
  const double yaw_rad = std::sqrt(of_source.covariance(2, 2));
  EXPECT_NEAR(place_ellipse(of_body.covariance).along_m, 2.0 * yaw_rad, 1e-3);
  EXPECT_NEAR(of_body.covariance(2, 2), yaw_rad * yaw_rad, 1e-9);
}

TEST(SlamSmoother, EllipseOfAPlaceLiesAlongWhatIsKnownLeast) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.7).toRotationMatrix();
  covariance.topLeftCorner<2, 2>() = turn * Eigen::Vector2d(4.0, 0.25).asDiagonal() * turn.transpose();
  const PlaceEllipse ellipse = place_ellipse(covariance);
  EXPECT_NEAR(ellipse.along_m, 2.0, 1e-12);
  EXPECT_NEAR(ellipse.across_m, 0.5, 1e-12);
  EXPECT_NEAR(ellipse.direction_rad, 0.7, 1e-12);
}

TEST(SlamSmoother, SaysWhatTheRecordingDoesNotTell) {
  const auto solved = solve({.duration_s = 200.0}, {});
  ASSERT_TRUE(solved);
  const auto& unknown = solved->report.not_observable;
  EXPECT_THAT(unknown, testing::Contains("constant of heading compass")) << "no fix says where north is";
  EXPECT_THAT(unknown, testing::Not(testing::Contains("angle of the velocity")));
  EXPECT_THAT(unknown, testing::Not(testing::Contains("cos1 of heading compass")));
  EXPECT_TRUE(solved->report.implausible.empty());
  ASSERT_TRUE(solved->report.velocity_check);
  EXPECT_LT(solved->report.velocity_check->difference_m_s, 0.1);
}

// Kills limits of another unknown, and a limit that nothing passes.
TEST(SlamSmoother, SaysWhatOfTheCalibrationIsFarFromWhatWasBelieved) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 400.0};
  std::vector<NavSource> sources = basin.sources(1);
  for (NavSource& source : sources) {
    if (source.quantity != NavQuantity::kVelocity) continue;
    for (NavSample& sample : source.samples) sample.value *= 1.1;  // as with a wrong speed of sound
  }
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_THAT(solved->report.implausible, testing::ElementsAre("scale of the velocity"));
}

// Kills a wrong trajectory that is believed to the centimetre: a DVL that says that the vehicle stands still.
TEST(SlamSmoother, SaysThatTheSonarContradictsTheVelocity) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 200.0};
  std::vector<NavSource> sources = basin.sources(1);
  for (NavSample& sample : sources[0].samples) sample.value *= 1e-3;
  for (const Estimation estimation : {Estimation::kBatch, Estimation::kCausal}) {
    SlamOptions options;
    options.estimation = estimation;
    SlamSmoother smoother = smoother_of(basin, options);
    add(smoother, sources);
    for (const Beam& beam : basin.beams()) smoother.add(beam);
    const auto solved = smoother.solve();
    ASSERT_TRUE(solved) << solved.error().message;
    EXPECT_THAT(solved->report.implausible, testing::Contains(testing::StartsWith("velocity of dvl (")));
    if (estimation == Estimation::kCausal) continue;
    double squares_m2 = 0.0;
    for (const PoseCovariance& pose : solved->covariances) squares_m2 += pose.covariance.topLeftCorner<2, 2>().trace();
    const double believed_m = std::sqrt(squares_m2 / static_cast<double>(solved->covariances.size()));
    EXPECT_LT(error_m(solved->trajectory), 3.0 * believed_m);
  }
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

// Without a velocity.

Result<SlamSolution> solve_without_velocity(const Basin& basin, SlamOptions options, const NavSource& turning) {
  options.seed = 3;
  SlamSmoother smoother = smoother_of(basin, std::move(options));
  add(smoother, {turning});
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  return smoother.solve();
}

/// The turn rate of a gyro with a bias.
NavSource gyro_of(const Basin& basin) {
  NavSource gyro{"gyro", NavQuantity::kTurnRate, {}};
  for (int i = 0; 0.2 * i <= basin.duration_s; ++i) {
    NavSample sample;
    sample.time_s = 0.2 * i;
    const double turned_rad = Basin::at(sample.time_s + 0.01).yaw_rad - Basin::at(sample.time_s - 0.01).yaw_rad;
    sample.value.z() = std::remainder(turned_rad, 2.0 * std::numbers::pi) / 0.02 + 3e-4;
    gyro.samples.push_back(sample);
  }
  return gyro;
}

TEST(SlamSmoother, FindsTheWayOfAVehicleWithoutVelocityByItsSonar) {
  const Basin basin{.duration_s = 250.0, .compass_cos = 0.02};
  const auto solved = solve_without_velocity(basin, {}, basin.sources()[1]);
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_LT(error_m(solved->trajectory), 0.5);
  ASSERT_TRUE(solved->report.by_sonar);
  EXPECT_GT(solved->report.by_sonar->matched, 22U);
  EXPECT_GT(solved->report.by_sonar->drift_m, 0.5);
  EXPECT_NEAR(solved->calibration.velocity_scale.value, 0.0, 1e-6);
}

TEST(SlamSmoother, GivesTheSameBytesWithoutVelocity) {
  const Basin basin{.duration_s = 100.0};
  const auto solved = solve_without_velocity(basin, {}, basin.sources()[1]);
  const auto same = solve_without_velocity(basin, {}, basin.sources()[1]);
  ASSERT_TRUE(solved && same);
  for (std::size_t i = 0; i < same->trajectory.poses().size(); ++i) {
    ASSERT_EQ(same->trajectory.poses()[i].map_from_body.matrix(), solved->trajectory.poses()[i].map_from_body.matrix());
  }
}

TEST(SlamSmoother, FindsTheWayByTheSonarAndAGyroThatDrifts) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 400.0};
  const auto solved = solve_without_velocity(basin, {}, gyro_of(basin));
  ASSERT_TRUE(solved) << solved.error().message;
  const auto& poses = solved->trajectory.poses();
  // A gyro does not know where north is: the way back to where it began does not depend on that.
  EXPECT_NEAR((poses.back().map_from_body.translation() - poses.front().map_from_body.translation()).norm(),
              (Basin::at(poses.back().time_s).place - Basin::at(poses.front().time_s).place).norm(), 0.5);
  EXPECT_EQ(solved->report.heading, "gyro");
}

// Kills odometry by the sonar that forgets, jumps or is taken twice where it goes on, and that of later sweeps.
TEST(SlamSmoother, FindsTheWayWithoutVelocityAsOnBoard) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 400.0, .compass_cos = 0.02};
  SlamOptions causal;
  causal.estimation = Estimation::kCausal;
  causal.causal_sweeps = 12;
  const auto solved = solve_without_velocity(basin, causal, basin.sources()[1]);
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_LT(error_m(solved->trajectory), 1.0);
  EXPECT_EQ(solved->trajectory.poses().size(), 4000U);
  ASSERT_TRUE(solved->report.by_sonar);
  EXPECT_GT(solved->report.by_sonar->matched, 36U);
  EXPECT_LE(solved->report.by_sonar->matched, 39U);
  const auto sooner = solve_without_velocity({.duration_s = 301.0, .compass_cos = 0.02}, causal, basin.sources()[1]);
  ASSERT_TRUE(sooner);
  for (std::size_t i = 0; i < 2990; ++i) {
    ASSERT_EQ(solved->trajectory.poses()[i].map_from_body.matrix(),
              sooner->trajectory.poses()[i].map_from_body.matrix());
  }
}

TEST(SlamSmoother, FindsTheWayByTheSonarAloneAsOnBoard) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const Basin basin{.duration_s = 300.0};
  SlamOptions causal;
  causal.estimation = Estimation::kCausal;
  SlamSmoother smoother = smoother_of(basin, causal);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  const auto& poses = solved->trajectory.poses();
  EXPECT_NEAR((poses.back().map_from_body.translation() - poses.front().map_from_body.translation()).norm(),
              (Basin::at(poses.back().time_s).place - Basin::at(poses.front().time_s).place).norm(), 2.0);
}

// What it cannot use.

void expect_refused(const SlamSmoother& smoother, const char* reason) {
  const auto solved = smoother.solve();
  ASSERT_FALSE(solved);
  EXPECT_THAT(solved.error().message, HasSubstr(reason));
}

TEST(SlamSmoother, RefusesToGuessWithoutBeamsOrHeading) {
  const Basin basin;
  const auto sources = basin.sources();
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  expect_refused(smoother, "no beams");

  SlamSmoother turning = smoother_of(basin, {});
  for (const Beam& beam : basin.beams()) turning.add(beam);
  add(turning, {sources[0]});
  expect_refused(turning, "no valid heading");
}

// Kills a trajectory that nothing tells: a vehicle that stands still, or goes on for ever.
TEST(SlamSmoother, RefusesToGuessWithoutVelocityAndEchoes) {
  const Basin basin{.duration_s = 100.0};
  for (const bool has_heading : {true, false}) {
    SlamSmoother smoother = smoother_of(basin, {});
    if (has_heading) add(smoother, {basin.sources()[1]});
    for (Beam beam : basin.beams()) {
      std::ranges::fill(beam.intensities, std::uint8_t{0});
      smoother.add(std::move(beam));
    }
    expect_refused(smoother, "0 of 9 sweeps match");
  }
}

TEST(SlamSmoother, RefusesAHeadingOfAnotherTimeWithoutVelocity) {
  const Basin basin{.duration_s = 100.0};
  NavSource compass = basin.sources()[1];
  for (NavSample& sample : compass.samples) sample.time_s += 10'000.0;
  const auto solved = solve_without_velocity(basin, {}, compass);
  ASSERT_FALSE(solved);
  EXPECT_THAT(solved.error().message, HasSubstr("do not overlap in time"));
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

// Kills turns that are made up where the clock of the navigation jumps ahead.
TEST(SlamSmoother, RefusesBeamsWhereNoHeadingIsKnown) {
  const Basin basin{.duration_s = 200.0};
  std::vector<NavSource> sources = basin.sources();
  for (NavSource& source : sources) {
    for (NavSample& sample : source.samples) sample.time_s += sample.time_s > 100.0 ? 3600.0 : 0.0;
  }
  for (const Estimation estimation : {Estimation::kBatch, Estimation::kCausal}) {
    SlamOptions options;
    options.estimation = estimation;
    SlamSmoother smoother = smoother_of(basin, options);
    add(smoother, sources);
    for (const Beam& beam : basin.beams()) smoother.add(beam);
    expect_refused(smoother, "no heading is known from 100.000 to 3700.200 s, where there are 1000 beams");
  }
}

// Kills a log whose clock was set back, added as a whole.
TEST(SlamSmoother, RefusesNavigationWhoseClockWasSetBack) {
  const Basin basin{.duration_s = 60.0};
  std::vector<NavSource> sources = basin.sources();
  for (NavSample& sample : sources[1].samples) sample.time_s -= sample.time_s > 30.0 ? 20.0 : 0.0;
  const auto log = NavLog::make(sources, NavClock::kUnknown);
  ASSERT_TRUE(log);
  SlamSmoother smoother = smoother_of(basin, {});
  const auto added = smoother.add(*log);
  ASSERT_FALSE(added);
  EXPECT_THAT(added.error().message, HasSubstr("heading of compass runs back"));
}

// Kills a solution without any step, whose calibration has no deviations.
TEST(SlamSmoother, ReckonsAlongOneSweepAlone) {
  const Basin basin{.duration_s = 10.0};
  for (const Estimation estimation : {Estimation::kBatch, Estimation::kCausal}) {
    SlamOptions options;
    options.estimation = estimation;
    const auto solved = solve(basin, options);
    ASSERT_TRUE(solved) << solved.error().message;
    EXPECT_EQ(solved->report.pairs, 0U);
    EXPECT_FALSE(solved->report.velocity_check);
    EXPECT_GT(solved->calibration.velocity_yaw_rad.deviation, 0.0);
    EXPECT_LT(error_m(solved->trajectory), 0.5);
  }
  SlamSmoother without = smoother_of(basin, {});
  add(without, {basin.sources()[1]});
  for (const Beam& beam : basin.beams()) without.add(beam);
  expect_refused(without, "only one sweep");
}

TEST(SlamSmoother, RefusesVelocitiesThatNoVehicleHas) {
  const Basin basin{.duration_s = 60.0};
  for (const Estimation estimation : {Estimation::kBatch, Estimation::kCausal}) {
    for (const double velocity_m_s : {40.0, 1e6, 1e300}) {
      SlamOptions options;
      options.estimation = estimation;
      SlamSmoother smoother = smoother_of(basin, options);
      std::vector<NavSource> sources = basin.sources();
      for (NavSample& sample : sources[0].samples) sample.value.x() = velocity_m_s;
      add(smoother, sources);
      for (const Beam& beam : basin.beams()) smoother.add(beam);
      expect_refused(smoother, "m/s in the median");
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
