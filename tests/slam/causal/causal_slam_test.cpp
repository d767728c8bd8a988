// Estimation while beams and navigation come, in a basin whose truth is known.

#include "pingvox/slam/causal_slam.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "pingvox/nav/trajectory_score.hpp"
#include "pingvox/slam/causal_replay.hpp"
#include "slam/basin.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

SlamOptions options_of(const Basin& basin) {
  SlamOptions options;
  options.body_from_sonar = pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, basin.sonar_yaw_rad);
  options.causal_sweeps = 8;
  return options;
}

Result<SlamSolution> replay(const Basin& basin) {
  CausalReplay recording(options_of(basin));
  for (const NavSource& source : basin.sources()) {
    for (const NavSample& sample : source.samples) {
      if (const auto added = recording.add(source.name, source.quantity, sample); !added) {
        return tl::unexpected(added.error());
      }
    }
  }
  for (const Beam& beam : basin.beams()) recording.add(beam);
  return recording.solve();
}

void expect_same(const Trajectory& one, const Trajectory& other) {
  ASSERT_EQ(one.poses().size(), other.poses().size());
  for (std::size_t i = 0; i < one.poses().size(); ++i) {
    ASSERT_EQ(one.poses()[i].map_from_body.matrix(), other.poses()[i].map_from_body.matrix()) << i;
  }
}

// Kills a pose that is not carried on, is of another frame or heading, or has another origin, and a window that loses
// what it needs: two thirds of the sweeps leave it.
TEST(CausalSlam, TellsWhileItGoesWhatTheReplayTellsOfTheLog) {
  const Basin basin{.duration_s = 240.0};
  const std::vector<NavSource> sources = basin.sources();
  CausalSlam slam(options_of(basin));
  std::vector<std::size_t> added(sources.size(), 0);
  std::vector<StampedPose> told;
  const auto add_until = [&](double time_s) {
    for (std::size_t s = 0; s < sources.size(); ++s) {
      const auto& samples = sources[s].samples;
      for (; added[s] < samples.size() && samples[added[s]].time_s <= time_s; ++added[s]) {
        ASSERT_TRUE(slam.add(sources[s].name, sources[s].quantity, samples[added[s]]));
      }
    }
  };
  for (const Beam& beam : basin.beams()) {
    add_until(beam.time_s);
    ASSERT_TRUE(slam.add(beam));
    const auto pose = slam.pose();
    // Two sweeps of ten seconds have ended when the third begins.
    ASSERT_EQ(pose.has_value(), beam.time_s > 19.95) << beam.time_s;
    if (!pose) continue;
    EXPECT_LE(pose->time_s, beam.time_s + 1e-9);
    EXPECT_GT(pose->time_s, beam.time_s - 0.7);
    told.push_back(*pose);
  }
  add_until(basin.duration_s);
  const auto finished = slam.finish();
  ASSERT_TRUE(finished) << finished.error().message;
  const auto solved = replay(basin);
  ASSERT_TRUE(solved) << solved.error().message;
  expect_same(finished->trajectory, solved->trajectory);
  EXPECT_EQ(finished->report.beams, 2400U);
  EXPECT_EQ(finished->report.sweeps, solved->report.sweeps);
  EXPECT_EQ(finished->report.echoes, solved->report.echoes);
  for (const StampedPose& pose : told) {
    const auto later = finished->trajectory.at(pose.time_s);
    if (!later) continue;
    const Pose off = later->inverse() * pose.map_from_body;
    // The velocity's next sample was not known yet, in which the vehicle turns.
    ASSERT_LT(off.translation().norm(), 0.05) << pose.time_s;
    ASSERT_LT(Eigen::AngleAxisd(off.rotation()).angle(), 0.03) << pose.time_s;
  }
}

/// All of a basin as it comes.
void add_all(const Basin& basin, CausalSlam& slam) {
  const std::vector<NavSource> sources = basin.sources();
  std::vector<std::size_t> added(sources.size(), 0);
  for (const Beam& beam : basin.beams()) {
    for (std::size_t s = 0; s < sources.size(); ++s) {
      const auto& samples = sources[s].samples;
      for (; added[s] < samples.size() && samples[added[s]].time_s <= beam.time_s; ++added[s]) {
        ASSERT_TRUE(slam.add(sources[s].name, sources[s].quantity, samples[added[s]]));
      }
    }
    ASSERT_TRUE(slam.add(beam));
  }
}

// Kills a path in another frame, and one that loses beams where they leave the window.
TEST(CausalSlam, ItsPathIsWhatItToldWhereNothingIsCorrected) {
  SlamOptions options = options_of({});
  options.matching = Matching::kNone;
  CausalSlam slam(options);
  EXPECT_FALSE(slam.path());
  EXPECT_TRUE(slam.newest_path().empty());
  EXPECT_FALSE(slam.motion());
  add_all({.duration_s = 240.0}, slam);
  const auto early = slam.path();
  ASSERT_TRUE(early);
  EXPECT_EQ(slam.solutions(), 11U) << "of 23 sweeps that ended";
  // A window of eight sweeps, and the two that just left it.
  const std::vector<StampedPose> newest = slam.newest_path();
  EXPECT_NEAR(static_cast<double>(newest.size()), 1000.0, 30.0);
  EXPECT_EQ(newest.back().time_s, early->poses().back().time_s);
  EXPECT_EQ(newest.front().map_from_body.matrix(), early->at(newest.front().time_s)->matrix());
  ASSERT_TRUE(slam.motion());
  EXPECT_EQ(slam.motion()->velocity, "dvl");
  EXPECT_FALSE(slam.motion()->by_sonar);
  EXPECT_GT(slam.motion()->deviation_m_sqrt_s, 0.0);

  const auto finished = slam.finish();
  ASSERT_TRUE(finished) << finished.error().message;
  const auto path = slam.path();
  ASSERT_TRUE(path);
  const std::vector<StampedPose>&told = finished->trajectory.poses(), &found = path->poses();
  ASSERT_EQ(found.size(), told.size());
  for (std::size_t i = 0; i < told.size(); ++i) {
    ASSERT_EQ(found[i].time_s, told[i].time_s);
    ASSERT_LT((found[i].map_from_body.matrix() - told[i].map_from_body.matrix()).norm(), 1e-6) << i;
  }
}

/// Root of the mean square distance from the truth, turned and moved to fit.
double error_m(const Trajectory& found) {
  std::vector<StampedPose> truth;
  for (const StampedPose& pose : found.poses()) {
    const Basin::State state = Basin::at(pose.time_s);
    truth.push_back({pose.time_s, pose_from_rpy({state.place.x(), state.place.y(), 0.0}, 0.0, 0.0, state.yaw_rad)});
  }
  return score_trajectory(found, *Trajectory::make(std::move(truth)))->se2.rmse_m;
}

// Kills a path that is not corrected when a place is seen again, and one whose last part alone is.
TEST(CausalSlam, ItsPathIsBetterThanWhatItToldAfterALoop) {
  const Basin basin{.duration_s = 480.0};
  SlamOptions options = options_of(basin);
  options.causal_sweeps = 80;
  CausalSlam slam(options);
  add_all(basin, slam);
  const auto finished = slam.finish();
  ASSERT_TRUE(finished) << finished.error().message;
  const auto path = slam.path();
  ASSERT_TRUE(path);
  EXPECT_LT(error_m(*path), 0.6 * error_m(finished->trajectory));
  EXPECT_LT(error_m(*path), 0.5);
}

// Kills a pose of another time than the one that is asked for.
TEST(CausalSlam, TellsThePoseOfATime) {
  const Basin basin{.duration_s = 60.0};
  CausalSlam slam(options_of(basin));
  add_all(basin, slam);
  const auto last = slam.pose();
  ASSERT_TRUE(last);
  ASSERT_GT(last->time_s, 55.0);
  const auto before = slam.pose(last->time_s - 2.0);
  ASSERT_TRUE(before);
  EXPECT_EQ(before->time_s, last->time_s - 2.0);
  const double moved_m = (Basin::at(last->time_s).place - Basin::at(before->time_s).place).norm();
  EXPECT_NEAR((last->map_from_body.translation() - before->map_from_body.translation()).norm(), moved_m, 0.15);
  EXPECT_EQ(slam.pose(1000.0)->map_from_body.matrix(), last->map_from_body.matrix());
  // What is solved already is told by the path.
  EXPECT_EQ(slam.pose(10.0)->time_s, slam.path()->poses().back().time_s);
}

// Kills a pose that stays at the end of the last sweep that was matched.
TEST(CausalSlam, GoesOnBySonarAndCompassBetweenTheSweeps) {
  const Basin basin{.duration_s = 160.0, .compass_cos = 0.02};
  const NavSource compass = basin.sources()[1];
  SlamOptions options = options_of(basin);
  options.motion = MotionSource::kSonar;
  CausalSlam slam(options);
  std::size_t added = 0, told = 0;
  for (const Beam& beam : basin.beams()) {
    for (; compass.samples[added].time_s <= beam.time_s; ++added) {
      ASSERT_TRUE(slam.add(compass.name, compass.quantity, compass.samples[added]));
    }
    ASSERT_TRUE(slam.add(beam));
    const auto pose = slam.pose();
    if (!pose || beam.time_s < 60.0) continue;
    ++told;
    ASSERT_GT(pose->time_s, beam.time_s - 0.25);
    const Eigen::Vector2d moved = Basin::at(pose->time_s).place - Basin::at(0.0).place;
    ASSERT_LT((pose->map_from_body.translation().head<2>() - moved).norm(), 3.5) << pose->time_s;
  }
  EXPECT_GT(told, 900U);
}

// Kills samples that are kept as they came, and a use of those that are of later times.
TEST(CausalSlam, NavigationMayComeEarlyAndInAnyOrder) {
  const Basin basin{.duration_s = 160.0};
  CausalSlam slam(options_of(basin));
  for (const NavSource& source : basin.sources()) {
    for (auto sample = source.samples.rbegin(); sample != source.samples.rend(); ++sample) {
      ASSERT_TRUE(slam.add(source.name, source.quantity, *sample));
    }
  }
  for (const Beam& beam : basin.beams()) ASSERT_TRUE(slam.add(beam));
  const auto finished = slam.finish(), solved = replay(basin);
  ASSERT_TRUE(finished && solved);
  expect_same(finished->trajectory, solved->trajectory);
}

// Kills odometry by the sonar where a DVL is only late.
TEST(CausalSlam, WaitsForAVelocity) {
  const Basin basin{.duration_s = 100.0};
  CausalSlam slam(options_of(basin));
  for (const NavSource& source : basin.sources()) {
    for (const NavSample& sample : source.samples) {
      if (source.name == "dvl" && sample.time_s < 45.0) continue;
      ASSERT_TRUE(slam.add(source.name, source.quantity, sample));
    }
  }
  for (const Beam& beam : basin.beams()) ASSERT_TRUE(slam.add(beam));
  const auto finished = slam.finish();
  ASSERT_TRUE(finished) << finished.error().message;
  EXPECT_FALSE(finished->report.velocity.by_sonar);
  EXPECT_EQ(finished->trajectory.poses().front().time_s, 45.0);
}

// Kills poses that stop while the DVL has lost the bottom, and those that go on evenly then.
TEST(CausalSlam, GoesOnByTheSonarWhereTheVelocityIsMissing) {
  constexpr double kFrom_s = 100.0, kTo_s = 160.0;
  const Basin basin{.duration_s = 200.0, .velocity_yaw_rad = 0.0};
  const std::vector<NavSource> sources = basin.sources();
  CausalSlam slam(options_of(basin));
  std::vector<std::size_t> added(sources.size(), 0);
  double greatest_m = 0.0;
  for (const Beam& beam : basin.beams()) {
    for (std::size_t s = 0; s < sources.size(); ++s) {
      const auto& samples = sources[s].samples;
      for (; added[s] < samples.size() && samples[added[s]].time_s <= beam.time_s; ++added[s]) {
        const NavSample& sample = samples[added[s]];
        if (s == 0 && sample.time_s > kFrom_s && sample.time_s < kTo_s) continue;
        ASSERT_TRUE(slam.add(sources[s].name, sources[s].quantity, sample));
      }
    }
    ASSERT_TRUE(slam.add(beam));
    const auto pose = slam.pose();
    if (!pose || beam.time_s < kFrom_s) continue;
    if (beam.time_s > kFrom_s + 20.0) {
      ASSERT_GT(pose->time_s, beam.time_s - 0.7);
    }
    const Eigen::Vector2d moved = Basin::at(pose->time_s).place - Basin::at(0.0).place;
    greatest_m = std::max(greatest_m, (pose->map_from_body.translation().head<2>() - moved).norm());
  }
  EXPECT_LT(greatest_m, 3.5);
  const auto finished = slam.finish();
  ASSERT_TRUE(finished) << finished.error().message;
  EXPECT_NEAR(finished->report.velocity.gaps_by_sonar_s, kTo_s - kFrom_s, 2.0);
}

// Kills a trajectory by the sonar alone that says to be by the velocity of another dive.
TEST(CausalSlam, NeedsAVelocityOfItsTimeToBegin) {
  const Basin basin{.duration_s = 60.0};
  CausalSlam slam(options_of(basin));
  for (const NavSource& source : basin.sources()) {
    for (NavSample sample : source.samples) {
      if (source.name == "dvl") sample.time_s -= 1000.0;
      ASSERT_TRUE(slam.add(source.name, source.quantity, sample));
    }
  }
  for (const Beam& beam : basin.beams()) ASSERT_TRUE(slam.add(beam));
  const auto finished = slam.finish();
  ASSERT_FALSE(finished);
  EXPECT_THAT(finished.error().message, HasSubstr("do not overlap in time"));
}

/// What is believed of one number is so narrow that no computer can weigh it.
SlamCalibration beyond_numbers() {
  SlamCalibration calibration;
  calibration.velocity = "dvl";
  for (Estimate* estimate : {&calibration.velocity_yaw_rad, &calibration.velocity_scale, &calibration.wall_in_echo,
                             &calibration.sonar_x_m, &calibration.sonar_y_m}) {
    *estimate = {0.0, 0.1};
  }
  calibration.sonar_x_m.deviation = 1e-200;
  return calibration;
}

// Kills an error that is told without a reason, or not at all, where the first solution failed and navigation ended.
TEST(CausalSlam, SaysThatTheFirstSolutionFailedAlsoAtTheEnd) {
  const Basin basin{.duration_s = 60.0};
  for (const double nav_until_s : {15.0, 19.9, 25.0, 60.0}) {
    SCOPED_TRACE(nav_until_s);
    SlamOptions options = options_of(basin);
    options.calibration = beyond_numbers();
    CausalSlam slam(options);
    for (const NavSource& source : basin.sources()) {
      for (const NavSample& sample : source.samples) {
        if (sample.time_s > nav_until_s) continue;
        ASSERT_TRUE(slam.add(source.name, source.quantity, sample));
      }
    }
    std::size_t refused = 0;
    for (const Beam& beam : basin.beams()) {
      if (slam.add(beam)) continue;
      ++refused;
      EXPECT_FALSE(slam.pose());
    }
    EXPECT_GE(refused, 1U);
    const auto finished = slam.finish();
    ASSERT_FALSE(finished);
    EXPECT_EQ(finished.error().code, Error::Code::kUnsupported);
    EXPECT_THAT(finished.error().message, HasSubstr("does not determine the trajectory"));
  }
}

// Kills a source of the navigation that is taken for odometry by the sonar, as it has its name.
TEST(CausalSlam, ASourceMayHaveTheNameOfOdometryByTheSonar) {
  const Basin basin{.duration_s = 100.0};
  const auto told_with_names = [&](const std::string& velocity, const std::string& heading) {
    CausalSlam slam(options_of(basin));
    for (const NavSource& source : basin.sources()) {
      const bool is_velocity = source.quantity == NavQuantity::kVelocity;
      const std::string& name = is_velocity ? velocity : source.name == "compass" ? heading : source.name;
      for (const NavSample& sample : source.samples) EXPECT_TRUE(slam.add(name, source.quantity, sample));
    }
    for (const Beam& beam : basin.beams()) EXPECT_TRUE(slam.add(beam));
    return slam.finish();
  };
  const auto usual = told_with_names("dvl", "compass");
  const auto velocity = told_with_names("sonar odometry", "compass");
  const auto heading = told_with_names("dvl", "sonar odometry");
  ASSERT_TRUE(usual && velocity && heading);
  expect_same(usual->trajectory, velocity->trajectory);
  expect_same(usual->trajectory, heading->trajectory);
  EXPECT_FALSE(velocity->report.velocity.by_sonar);
  EXPECT_EQ(velocity->report.velocity.source, "sonar odometry");
}

TEST(CausalSlam, RefusesBeamsThatGoBackInTime) {
  const Basin basin{.duration_s = 1.0};
  const std::vector<Beam> beams = basin.beams();
  CausalSlam slam(options_of(basin));
  ASSERT_TRUE(slam.add(beams[5]));
  const auto added = slam.add(beams[4]);
  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().code, Error::Code::kCorrupt);
  EXPECT_THAT(added.error().message, HasSubstr("0.500 s, then 0.400 s"));
}

TEST(CausalSlam, SaysWhatIsMissing) {
  const Basin basin{.duration_s = 50.0};
  {
    CausalSlam slam(options_of(basin));
    const auto finished = slam.finish();
    ASSERT_FALSE(finished);
    EXPECT_EQ(finished.error().message, "there are no beams");
  }
  for (const MotionSource motion : {MotionSource::kVelocity, MotionSource::kSonar}) {
    SlamOptions options = options_of(basin);
    options.motion = motion;
    CausalSlam slam(options);
    for (Beam beam : basin.beams()) {
      if (motion == MotionSource::kSonar) std::ranges::fill(beam.intensities, std::uint8_t{0});
      ASSERT_TRUE(slam.add(std::move(beam)));
    }
    EXPECT_FALSE(slam.pose());
    const auto finished = slam.finish();
    ASSERT_FALSE(finished);
    EXPECT_EQ(finished.error().code, Error::Code::kUnsupported);
    EXPECT_THAT(finished.error().message, HasSubstr("no valid velocity and no heading"));
    EXPECT_EQ(finished.error().message.ends_with("and motion cannot be estimated from the sonar"),
              motion == MotionSource::kSonar);
  }
}

}  // namespace
}  // namespace pingvox::test
