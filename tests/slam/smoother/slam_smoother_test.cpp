// The smoother in a basin whose truth is known. Input that it cannot use: slam_smoother_input_test.cpp.

#include "pingvox/slam/slam_smoother.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "pingvox/slam/odometry.hpp"
#include "slam/smoother_in_basin.hpp"
#include "support/rounds.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

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
  EXPECT_GT(solved->report.pairs.count, 5000U);
  EXPECT_GT(solved->report.pairs.loops.kept, 0U);
}

TEST(SlamSmoother, FindsLoopsOfSubmapsWhereItGoesRoundAgain) {
  PINGVOX_SKIP_UNDER_SANITIZERS();
  const auto solved = solve(Basin{.duration_s = 560.0, .compass_cos = 0.3}, {});
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_LT(error_m(solved->trajectory), 0.5);
  EXPECT_GT(solved->report.pairs.submap_loops.kept, 2U);
  EXPECT_LE(solved->report.pairs.submap_loops.kept, solved->report.pairs.submap_loops.found);
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

// Kills bearings of a head that hangs upside down that are taken as those of one that stands.
TEST(SlamSmoother, AHeadThatIsUpsideDownSeesTheSame) {
  const Basin basin{.duration_s = 200.0};
  const auto upright = solve(basin, {});
  SlamOptions options;
  options.body_from_sonar = pose_from_rpy(Eigen::Vector3d::Zero(), std::numbers::pi, 0.0, basin.sonar_yaw_rad);
  SlamSmoother smoother(options);
  add(smoother, basin.sources());
  for (Beam beam : basin.beams()) {
    beam.bearing_rad = wrap_bearing(-beam.bearing_rad);
    smoother.add(beam);
  }
  const auto turned_over = smoother.solve();
  ASSERT_TRUE(upright && turned_over);
  EXPECT_GT(upright->report.pairs.count, 1000U);
  for (std::size_t i = 0; i < upright->trajectory.poses().size(); ++i) {
    const Pose &a = upright->trajectory.poses()[i].map_from_body, &b = turned_over->trajectory.poses()[i].map_from_body;
    ASSERT_TRUE(a.isApprox(b, 1e-6)) << i;
  }
}

TEST(SlamSmoother, RefusesAHeadThatLooksOutOfThePlane) {
  SlamOptions options;
  for (const double roll_rad : {1.0, -1.6, 2.1, std::nan("")}) {
    options.body_from_sonar = pose_from_rpy(Eigen::Vector3d::Zero(), roll_rad, 0.0, 0.0);
    const auto valid = options.validate();
    ASSERT_FALSE(valid) << roll_rad;
    EXPECT_THAT(valid.error().message, HasSubstr("body_from_sonar"));
  }
  options.body_from_sonar = pose_from_rpy(Eigen::Vector3d::Zero(), std::numbers::pi - 0.5, 0.3, 2.0);
  EXPECT_TRUE(options.validate());
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
  EXPECT_NEAR(solved->report.velocity.longest_gap_s, 20.5, 1.0) << "as measured";
  EXPECT_EQ(solved->report.velocity.samples, 1562U) << "as measured";
  EXPECT_NEAR(solved->report.velocity.gaps_by_sonar_s, 20.5, 1.0);
  EXPECT_LT(error_m(solved->trajectory), 0.5);
}

/// The solution of a sonar that pauses from 100 to 130 s.
Result<SlamSolution> solve_with_pause(const Basin& basin, const std::vector<NavSource>& sources) {
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) {
    if (beam.time_s < 100.0 || beam.time_s > 130.0) smoother.add(beam);
  }
  return smoother.solve();
}

// Kills a straight line through the time in which the head stopped: later beams would be mapped along it.
TEST(SlamSmoother, HasAGapWhereBeamsAndVelocitiesPause) {
  const Basin basin{.duration_s = 200.0};
  for (const std::size_t silent : {0U, 1U}) {
    std::vector<NavSource> sources = basin.sources();
    std::erase_if(sources[silent].samples,
                  [](const NavSample& sample) { return sample.time_s > 105.0 && sample.time_s < 125.0; });
    const auto solved = solve_with_pause(basin, sources);
    ASSERT_TRUE(solved) << solved.error().message;
    EXPECT_EQ(solved->trajectory.gaps(), 1U);
    EXPECT_EQ(solved->report.in_pauses, 0U);
    EXPECT_TRUE(solved->trajectory.at(90.0));
    EXPECT_FALSE(solved->trajectory.at(115.0));
  }
}

// Kills a gap, or a straight line, where only the head stopped.
TEST(SlamSmoother, TheNavigationTellsTheWayInAPauseOfTheSonar) {
  const Basin basin{.duration_s = 200.0};
  const auto solved = solve_with_pause(basin, basin.sources());
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_EQ(solved->trajectory.gaps(), 0U);
  EXPECT_GT(solved->report.in_pauses, 25U);
  EXPECT_EQ(solved->trajectory.poses().size(), solved->report.beams + solved->report.in_pauses);
  const auto before = solved->trajectory.at(95.0), within = solved->trajectory.at(115.0);
  ASSERT_TRUE(before && within);
  const Eigen::Vector2d moved = (within->translation() - before->translation()).head<2>();
  EXPECT_LT((moved - (Basin::at(115.0).place - Basin::at(95.0).place)).norm(), 0.3) << "a line is 0.5 m off";
}

// Kills a trajectory that ends with its DVL while the sonar hears on.
TEST(SlamSmoother, GoesOnByTheSonarAfterTheLastVelocity) {
  const Basin basin{.duration_s = 200.0};
  std::vector<NavSource> sources = basin.sources();
  std::erase_if(sources[0].samples, [](const NavSample& sample) { return sample.time_s > 120.0; });
  SlamSmoother smoother = smoother_of(basin, {});
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  const auto solved = smoother.solve();
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_GT(solved->trajectory.poses().back().time_s, 185.0);
  EXPECT_GT(solved->report.velocity.longest_gap_s, 65.0);
  EXPECT_GT(solved->report.velocity.gaps_by_sonar_s, 65.0);
  EXPECT_LT(error_m(solved->trajectory), 1.0);
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

// Kills a source of the navigation that is taken for odometry by the sonar, as it has its name.
TEST(SlamSmoother, ASourceMayHaveTheNameOfOdometryByTheSonar) {
  const Basin basin{.duration_s = 200.0};
  const NavSource compass = basin.sources()[1];
  NavSource other = compass;
  other.name = "sonar odometry";
  const auto usual = solve_without_velocity(basin, {}, compass), renamed = solve_without_velocity(basin, {}, other);
  ASSERT_TRUE(usual && renamed);
  EXPECT_TRUE(renamed->report.velocity.by_sonar);
  EXPECT_EQ(renamed->report.clock_check.has_value(), usual->report.clock_check.has_value());
  ASSERT_EQ(renamed->trajectory.poses().size(), usual->trajectory.poses().size());
  for (std::size_t i = 0; i < usual->trajectory.poses().size(); ++i) {
    ASSERT_EQ(renamed->trajectory.poses()[i].map_from_body.matrix(),
              usual->trajectory.poses()[i].map_from_body.matrix());
  }
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
  ASSERT_TRUE(at_source && behind && reckoned);
  EXPECT_EQ(at_source->covariances.size(), at_source->report.knots);
  EXPECT_LT(place_ellipse(at_source->covariances.front().covariance).along_m, 0.01);
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
  const auto solved = solve({.duration_s = 400.0}, {});
  ASSERT_TRUE(solved);
  const auto& unknown = solved->report.not_observable;
  EXPECT_THAT(unknown, testing::Contains("constant of heading compass")) << "no fix says where north is";
  EXPECT_THAT(unknown, testing::Not(testing::Contains("angle of the velocity")));
  EXPECT_THAT(unknown, testing::Not(testing::Contains("cos1 of heading compass")));
  EXPECT_TRUE(solved->report.implausible.empty());
  ASSERT_TRUE(solved->report.velocity.check);
  EXPECT_LT(solved->report.velocity.check->difference_m_s, 0.1);
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
  const auto solved = solve(basin, {}, sources);
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_THAT(solved->report.implausible, testing::Contains(testing::StartsWith("velocity of dvl (")));
  double squares_m2 = 0.0;
  for (const PoseCovariance& pose : solved->covariances) squares_m2 += pose.covariance.topLeftCorner<2, 2>().trace();
  const double believed_m = std::sqrt(squares_m2 / static_cast<double>(solved->covariances.size()));
  EXPECT_LT(error_m(solved->trajectory), 3.0 * believed_m);
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
  ASSERT_TRUE(solved->report.velocity.by_sonar);
  EXPECT_GT(solved->report.velocity.by_sonar->matched, 22U);
  EXPECT_GT(solved->report.velocity.by_sonar->drift_m, 0.5);
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

}  // namespace
}  // namespace pingvox::test
