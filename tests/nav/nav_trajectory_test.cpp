#include "pingvox/nav/nav_trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

struct Said {
  double time_s;
  Eigen::Vector3d value;
  bool valid = true;
};

NavSource source_of(std::string name, NavQuantity quantity, const std::vector<Said>& said) {
  NavSource source{std::move(name), quantity, {}};
  for (const Said& one : said) {
    NavSample sample;
    sample.time_s = one.time_s;
    sample.value = one.value;
    sample.valid = one.valid;
    source.samples.push_back(sample);
  }
  return source;
}

Result<NavTrajectory> trajectory_of(std::vector<NavSource> sources, double offset_s = 0.0) {
  return NavLog::make(std::move(sources), NavClock::kBoot).and_then([&](const NavLog& log) {
    return nav_trajectory(log, offset_s);
  });
}

std::vector<double> times_of(const Trajectory& trajectory) {
  std::vector<double> times_s;
  for (const StampedPose& pose : trajectory.poses()) times_s.push_back(pose.time_s);
  return times_s;
}

const NavSource kLevel = source_of("ahrs", NavQuantity::kAttitude, {{0, {0, 0, 0}}, {1, {0, 0, 1}}, {2, {0, 0, 0.5}}});

TEST(NavTrajectory, HasAPoseAtEachTimeOfEitherSourceWhereBothAreKnown) {
  const auto made =
      trajectory_of({kLevel, source_of("dvl", NavQuantity::kPosition, {{0.5, {1, 2, 3}}, {1.5, {2, 2, 3}}})}, 100.0);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_THAT(times_of(made->trajectory), testing::ElementsAre(100.5, 101, 101.5));
  EXPECT_EQ(made->attitude, "ahrs");
  EXPECT_EQ(made->position, "dvl");
  const Pose half = *made->trajectory.at(100.75);
  EXPECT_TRUE(half.isApprox(pose_from_rpy({1.25, 2, 3}, 0, 0, 0.75), 1e-12)) << half.matrix();
}

// Kills a log that is refused for a clock that no pose depends on, and poses by one that was set back.
TEST(NavTrajectory, IsRefusedForTheClocksThatItUses) {
  const std::vector<Said> back = {{0, {0, 0, 0}}, {20, {0, 0, 0}}, {1, {0, 0, 0}}};
  const NavSource place = source_of("dvl", NavQuantity::kPosition, {{0.5, {1, 2, 3}}, {1.5, {2, 2, 3}}});
  EXPECT_TRUE(trajectory_of({kLevel, place, source_of("dvl", NavQuantity::kVelocity, back),
                             source_of("other", NavQuantity::kAttitude, back)}));
  const auto refused = [](std::vector<NavSource> sources) {
    const auto made = trajectory_of(std::move(sources));
    return made ? std::string("not refused") : made.error().message;
  };
  EXPECT_THAT(refused({kLevel, source_of("dvl", NavQuantity::kPosition, back)}),
              testing::HasSubstr("position of dvl runs back by 19.000 s"));
  EXPECT_THAT(refused({source_of("imu", NavQuantity::kAttitude, back), place}),
              testing::HasSubstr("attitude of imu runs back"));
  const NavSource fix = source_of("gps", NavQuantity::kFix, {{0.5, {0.1, 0.2, 0}}, {1.5, {0.1, 0.2, 0}}});
  EXPECT_THAT(refused({kLevel, fix, source_of("bar", NavQuantity::kDepth, back)}),
              testing::HasSubstr("depth of bar runs back"));
}

TEST(NavTrajectory, TurnsRollPitchAndYawAsPosesDo) {
  const auto made = trajectory_of({source_of("a", NavQuantity::kAttitude, {{0, {0.1, -0.2, 2.5}}}),
                                   source_of("p", NavQuantity::kPosition, {{0, {1, 2, 3}}})});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(made->trajectory.at(0)->isApprox(pose_from_rpy({1, 2, 3}, 0.1, -0.2, 2.5), 1e-12));
}

TEST(NavTrajectory, HasAGapWhereTheSlowerSourceHasOne) {
  NavSource fast{"ahrs", NavQuantity::kAttitude, {}}, slow{"usbl", NavQuantity::kPosition, {}};
  for (int i = 0; i <= 1000; ++i) fast.samples.push_back({.time_s = i * 0.1});
  // A fix every five seconds is no gap; thirty seconds without one are.
  for (const double time_s : {0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 60.0, 65.0}) slow.samples.push_back({.time_s = time_s});
  const auto made = trajectory_of({fast, slow});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->trajectory.gaps(), 1U);
  for (const double time_s : {2.57, 24.99, 60.0, 64.9}) EXPECT_TRUE(made->trajectory.at(time_s)) << time_s;
  for (const double time_s : {25.01, 40.0, 59.99, 65.1}) EXPECT_FALSE(made->trajectory.at(time_s)) << time_s;
}

// Kills a gap of the quicker source that is bridged since the slower one pauses as long.
TEST(NavTrajectory, HasAGapWhereTheQuickerSourceHasOne) {
  NavSource quick{"ahrs", NavQuantity::kAttitude, {}}, slow{"usbl", NavQuantity::kPosition, {}};
  for (int i = 0; i <= 100; ++i) slow.samples.push_back({.time_s = static_cast<double>(i)});
  for (int i = 0; i <= 1000; ++i) {
    if (i <= 400 || i >= 430) quick.samples.push_back({.time_s = i * 0.1});
  }
  const auto made = trajectory_of({quick, slow});
  ASSERT_TRUE(made) << made.error().message;
  for (const double time_s : {39.95, 40.0, 43.0, 43.05}) EXPECT_TRUE(made->trajectory.at(time_s)) << time_s;
  for (const double time_s : {40.05, 41.0, 42.5, 42.95}) EXPECT_FALSE(made->trajectory.at(time_s)) << time_s;
}

TEST(NavTrajectory, PrefersTheMainFilterToWhatSpeaksMoreOften) {
  const auto made =
      trajectory_of({source_of("AHRS2", NavQuantity::kAttitude, {{0, {0, 0, 1}}, {1, {0, 0, 1}}, {2, {0, 0, 1}}}),
                     source_of("ATTITUDE", NavQuantity::kAttitude, {{0, {0, 0, 0}}, {2, {0, 0, 0}}}),
                     source_of("LOCAL_POSITION_NED", NavQuantity::kPosition, {{0, {9, 9, 9}, false}}),
                     source_of("VISION_POSITION_ESTIMATE", NavQuantity::kPosition, {{0, {1, 0, 0}}, {1, {1, 0, 0}}})});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->attitude, "ATTITUDE");
  EXPECT_EQ(made->position, "VISION_POSITION_ESTIMATE") << "a source without valid samples is none";
  EXPECT_TRUE(made->trajectory.at(0)->isApprox(pose_from_rpy({1, 0, 0}, 0, 0, 0)));
}

// A DVL's dead reckoning starts where it was switched on: north is elsewhere than in the autopilot's attitude.
TEST(NavTrajectory, TakesTheAttitudeOfThePositionsOwnSource) {
  const auto made = trajectory_of({source_of("ATTITUDE", NavQuantity::kAttitude, {{0, {0, 0, 1}}, {1, {0, 0, 1}}}),
                                   source_of("A50", NavQuantity::kAttitude, {{0, {0, 0, 2}}, {1, {0, 0, 2}}}),
                                   source_of("A50", NavQuantity::kPosition, {{0, {1, 0, 0}}, {1, {1, 0, 0}}})});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(made->attitude, "A50");
  EXPECT_TRUE(made->trajectory.at(0)->isApprox(pose_from_rpy({1, 0, 0}, 0, 0, 2)));
  EXPECT_FALSE(made->origin_fix);
}

TEST(NavTrajectory, MakesMetresOfFixesAlsoAcrossTheDateLine) {
  // By tables a degree at 45 degrees north is 111.132 km long to the north, and 78.847 km to the east.
  const auto made = trajectory_of({kLevel, source_of("gps", NavQuantity::kFix,
                                                     {{0, {45.0 * kDegree_rad, 179.99995 * kDegree_rad, 50}},
                                                      {1, {45.0001 * kDegree_rad, -179.99995 * kDegree_rad, 52}}})});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(made->trajectory.at(0)->translation().isZero());
  const Eigen::Vector3d moved = made->trajectory.at(1)->translation();
  EXPECT_NEAR(moved.x(), 7.8847, 1e-4);
  EXPECT_NEAR(moved.y(), 11.1132, 1e-4);
  EXPECT_NEAR(moved.z(), 2.0, 1e-9) << "without a depth the altitude counts";
  EXPECT_TRUE(made->origin_fix->isApprox(Eigen::Vector3d(45.0 * kDegree_rad, 179.99995 * kDegree_rad, 50)));
}

TEST(NavTrajectory, PutsFixesAtTheDepthOfTheirTime) {
  const auto made = trajectory_of({kLevel, source_of("usbl", NavQuantity::kFix, {{0, {0.8, 0, 50}}, {1, {0.8, 0, 52}}}),
                                   source_of("bar", NavQuantity::kDepth, {{0.5, {4, 0, 0}}, {1.5, {6, 0, 0}}})});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_THAT(times_of(made->trajectory), testing::ElementsAre(1)) << "at 0 nobody knows the depth";
  EXPECT_NEAR(made->trajectory.at(1)->translation().z(), -5.0, 1e-12);
}

// Kills a depth that its device marked as invalid.
TEST(NavTrajectory, PutsNoFixAtADepthThatIsInvalid) {
  const NavSource fixes = source_of("usbl", NavQuantity::kFix, {{0.8, {0.8, 0, 50}}, {1, {0.8, 0, 52}}});
  const auto made = trajectory_of(
      {kLevel, fixes,
       source_of("bar", NavQuantity::kDepth, {{0.5, {4, 0, 0}}, {0.9, {900, 0, 0}, false}, {1.5, {6, 0, 0}}})});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_NEAR(made->trajectory.at(0.8)->translation().z(), -4.6, 1e-12);
  EXPECT_NEAR(made->trajectory.at(1)->translation().z(), -5.0, 1e-12);
}

TEST(NavTrajectory, SaysWhatIsMissing) {
  const NavSource place = source_of("p", NavQuantity::kPosition, {{5, {1, 2, 3}}});
  const auto error = [](const auto& made) { return made ? std::string("none") : made.error().message; };
  EXPECT_THAT(error(trajectory_of({kLevel})), testing::HasSubstr("no valid position"));
  EXPECT_THAT(error(trajectory_of({place})), testing::HasSubstr("no valid attitude"));
  EXPECT_THAT(error(trajectory_of({kLevel, place})), testing::HasSubstr("never known together"));
  EXPECT_EQ(trajectory_of({kLevel}).error().code, Error::Code::kUnsupported);
}

}  // namespace
}  // namespace pingvox
