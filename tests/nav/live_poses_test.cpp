// Poses while the samples come.

#include "pingvox/nav/live_poses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox::test {
namespace {

NavSample at(double time_s, const Eigen::Vector3d& value) {
  NavSample sample;
  sample.time_s = time_s;
  sample.value = value;
  return sample;
}

/// A vehicle that turns and goes ahead, ten samples a second of each source, as a log has them.
std::vector<NavSource> turning_vehicle(double duration_s) {
  NavSource attitude{"ATTITUDE", NavQuantity::kAttitude, {}};
  NavSource position{"LOCAL_POSITION_NED", NavQuantity::kPosition, {}};
  for (int i = 0; 0.1 * i < duration_s; ++i) {
    const double time_s = 0.1 * i;
    attitude.samples.push_back(at(time_s, {0.01, -0.02, 0.3 * time_s}));
    position.samples.push_back(at(time_s + 0.03, {time_s, 0.5 * time_s, -1.0}));
  }
  return {attitude, position};
}

void add_until(LivePoses& poses, const std::vector<NavSource>& sources, double from_s, double to_s) {
  for (const NavSource& source : sources) {
    for (const NavSample& sample : source.samples) {
      if (sample.time_s >= from_s && sample.time_s < to_s) poses.add(source.name, source.quantity, sample);
    }
  }
}

TEST(LivePoses, AreThoseOfTheWholeLog) {
  const std::vector<NavSource> sources = turning_vehicle(300.0);
  const auto log = NavLog::make(sources, NavClock::kUnknown);
  ASSERT_TRUE(log);
  const auto trajectory = nav_trajectory(*log);
  ASSERT_TRUE(trajectory);
  LivePoses poses;
  std::size_t known = 0;
  for (double time_s = 0.0; time_s < 299.0; time_s += 0.57) {
    add_until(poses, sources, time_s, time_s + 0.57);
    const double asked_s = time_s + 0.2;
    const std::optional<Pose> pose = poses.at(asked_s), whole = trajectory->trajectory.at(asked_s);
    if (!pose) continue;
    ASSERT_TRUE(whole);
    EXPECT_TRUE(pose->isApprox(*whole, 1e-9)) << asked_s;
    ++known;
  }
  EXPECT_GT(known, 515U);
  EXPECT_EQ(poses.attitude(), "ATTITUDE");
  EXPECT_EQ(poses.position(), "LOCAL_POSITION_NED");
}

TEST(LivePoses, AreNotKnownBeforeTheNextSampleNorInAGap) {
  LivePoses poses;
  const std::vector<NavSource> sources = turning_vehicle(20.0);
  EXPECT_FALSE(poses.known_until_s());
  add_until(poses, sources, 0.0, 5.0);
  ASSERT_TRUE(poses.known_until_s());
  EXPECT_NEAR(*poses.known_until_s(), 4.9, 0.031);
  EXPECT_TRUE(poses.at(4.5));
  EXPECT_FALSE(poses.at(4.99));
  add_until(poses, sources, 9.0, 20.0);
  EXPECT_FALSE(poses.at(7.0));
  EXPECT_TRUE(poses.at(15.0));
}

// Kills an origin that moves with the samples that are kept.
TEST(LivePoses, CountFixesFromTheFirstOneForEver) {
  LivePoses poses;
  constexpr double kStep_rad = 1e-8;
  Eigen::Vector3d fix(0.9, 0.1, 40.0);
  const Eigen::Vector3d first = fix;
  for (int i = 0; i < 3000; ++i) {
    const double time_s = 0.1 * i;
    poses.add("ATTITUDE", NavQuantity::kAttitude, at(time_s, {0.0, 0.0, 1.0}));
    poses.add("GPS", NavQuantity::kDepth, at(time_s, {5.0, 0.0, 0.0}));
    poses.add("GPS", NavQuantity::kFix, at(time_s, fix));
    fix.x() += kStep_rad;
  }
  const auto pose = poses.at(290.0);
  ASSERT_TRUE(pose);
  const Eigen::Vector3d moved = position_of_fix(first + 2900.0 * Eigen::Vector3d(kStep_rad, 0.0, 0.0), first);
  EXPECT_NEAR(pose->translation().x(), moved.x(), 1e-6);
  EXPECT_NEAR(pose->translation().y(), moved.y(), 1e-6);
  EXPECT_GT(moved.y(), 150.0);
  EXPECT_EQ(pose->translation().z(), -5.0);
}

// Kills poses that jump when another source speaks up later.
TEST(LivePoses, KeepTheSourcesThatTheyBeganWith) {
  LivePoses poses;
  const std::vector<NavSource> sources = turning_vehicle(10.0);
  add_until(poses, sources, 0.0, 3.0);
  for (int i = 0; i < 100; ++i) poses.add("other", NavQuantity::kPosition, at(3.0 + 0.01 * i, {100.0, 0.0, 0.0}));
  add_until(poses, sources, 3.0, 10.0);
  const auto pose = poses.at(3.5);
  ASSERT_TRUE(pose);
  EXPECT_LT(pose->translation().x(), 10.0);
}

// Kills an attitude of the autopilot for the position of a DVL that has its own: of each report the position comes
// first, so one second of it is there before one second of the attitude.
TEST(LivePoses, TakeTheAttitudeOfThePositionsOwnSource) {
  for (const bool position_first : {true, false}) {
    LivePoses poses;
    for (int i = 0; i < 30; ++i) {
      const double time_s = 0.1 * i;
      poses.add("ATTITUDE", NavQuantity::kAttitude, at(time_s - 0.01, {0.0, 0.0, 1.0}));
      if (position_first) poses.add("A50", NavQuantity::kPosition, at(time_s, {time_s, 0.0, 0.0}));
      poses.add("A50", NavQuantity::kAttitude, at(time_s, {0.0, 0.0, 2.0}));
      if (!position_first) poses.add("A50", NavQuantity::kPosition, at(time_s, {time_s, 0.0, 0.0}));
    }
    EXPECT_EQ(poses.position(), "A50");
    EXPECT_EQ(poses.attitude(), "A50") << position_first;
  }
}

TEST(LivePoses, SayWhatIsMissing) {
  LivePoses poses;
  poses.add("VFR_HUD", NavQuantity::kDepth, at(0.0, {2.0, 0.0, 0.0}));
  EXPECT_FALSE(poses.has(NavQuantity::kAttitude));
  EXPECT_FALSE(poses.has(NavQuantity::kPosition));
  NavSample invalid = at(0.0, {63.4, 10.4, 0.0});
  invalid.valid = false;
  poses.add("GPS_RAW_INT", NavQuantity::kFix, invalid);
  poses.add("ATTITUDE", NavQuantity::kAttitude, at(0.0, {0.0, 0.0, 0.0}));
  EXPECT_TRUE(poses.has(NavQuantity::kAttitude));
  EXPECT_FALSE(poses.has(NavQuantity::kPosition));
  poses.add("GPS_RAW_INT", NavQuantity::kFix, at(0.2, {63.4, 10.4, 0.0}));
  EXPECT_TRUE(poses.has(NavQuantity::kPosition));
}

TEST(LivePoses, LeaveOutWhatSaysNothing) {
  LivePoses poses;
  const std::vector<NavSource> sources = turning_vehicle(10.0);
  add_until(poses, sources, 0.0, 5.0);
  const auto before = poses.at(2.0);
  ASSERT_TRUE(before);
  NavSample broken = at(5.0, {1.0, 2.0, 3.0});
  broken.valid = false;
  poses.add("ATTITUDE", NavQuantity::kAttitude, broken);
  poses.add("ATTITUDE", NavQuantity::kAttitude, at(5.0, Eigen::Vector3d::Constant(std::nan(""))));
  poses.add("ATTITUDE", NavQuantity::kAttitude, at(std::numeric_limits<double>::infinity(), {0.0, 0.0, 0.0}));
  poses.add("ATTITUDE", NavQuantity::kAttitude, at(1.0, {3.0, 3.0, 3.0}));
  EXPECT_EQ(poses.at(2.0)->matrix(), before->matrix());
  EXPECT_NEAR(*poses.known_until_s(), 4.9, 0.031);
}

}  // namespace
}  // namespace pingvox::test
