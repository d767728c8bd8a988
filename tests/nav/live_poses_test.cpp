// Poses while the samples come.

#include "nav/internal/live_poses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
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
    attitude.samples.push_back(at(time_s, {0.01, -0.02, std::remainder(0.3 * time_s, 2.0 * std::numbers::pi)}));
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
  NavSample invalid = at(0.0, {1.1, 0.18, 0.0});
  invalid.valid = false;
  poses.add("GPS_RAW_INT", NavQuantity::kFix, invalid);
  poses.add("ATTITUDE", NavQuantity::kAttitude, at(0.0, {0.0, 0.0, 0.0}));
  EXPECT_TRUE(poses.has(NavQuantity::kAttitude));
  EXPECT_FALSE(poses.has(NavQuantity::kPosition));
  poses.add("GPS_RAW_INT", NavQuantity::kFix, at(0.2, {1.1, 0.18, 0.0}));
  EXPECT_TRUE(poses.has(NavQuantity::kPosition));
}

// Kills poses that are said to be known until the source that goes on, and not until the one that fell silent.
TEST(LivePoses, AreKnownUntilTheSourceThatFellSilent) {
  const std::vector<NavSource> sources = turning_vehicle(10.0);
  for (std::size_t silent = 0; silent < sources.size(); ++silent) {
    LivePoses poses;
    add_until(poses, sources, 0.0, 5.0);
    add_until(poses, {sources[1 - silent]}, 5.0, 10.0);
    EXPECT_NEAR(*poses.known_until_s(), 4.95, 0.06);
    EXPECT_TRUE(poses.at(*poses.known_until_s()));
    EXPECT_FALSE(poses.at(*poses.known_until_s() + 0.01));
  }
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

/// The same vehicle, 20 times a second, with what is added to its positions.
void add_with_steps(LivePoses& poses, double from_s, double to_s, const std::function<double(double)>& added_m) {
  for (int i = static_cast<int>(std::lround(20.0 * from_s)); 0.05 * i < to_s; ++i) {
    const double time_s = 0.05 * i;
    poses.add("ATTITUDE", NavQuantity::kAttitude, at(time_s, {0.0, 0.0, 0.3 * time_s}));
    poses.add("LOCAL_POSITION_NED", NavQuantity::kPosition, at(time_s, {0.5 * time_s + added_m(time_s), 0.0, 0.0}));
  }
}

// One outlier, and no beam of the rest of the dive had a pose; or the path went there and back.
TEST(LivePoses, AnOutlierIsLeftOut) {
  LivePoses poses;
  add_with_steps(poses, 0.0, 10.0, [](double time_s) { return std::abs(time_s - 5.0) < 0.01 ? 20.0 : 0.0; });
  for (const double time_s : {4.97, 5.0, 5.03, 9.0}) {
    const auto pose = poses.at(time_s);
    ASSERT_TRUE(pose) << time_s;
    EXPECT_NEAR(pose->translation().x(), 0.5 * time_s, 1e-9);
  }
  EXPECT_EQ(poses.outliers(), 1U);
  EXPECT_TRUE(poses.take_new_frames().empty());
}

// Kills a pose between two origins, and two maps in one without a word.
TEST(LivePoses, GoOnInANewFrameAndSayIt) {
  LivePoses poses;
  const auto step = [](double time_s) { return time_s > 4.99 ? 40.0 : 0.0; };
  add_with_steps(poses, 0.0, 5.3, step);
  EXPECT_NEAR(poses.known_until_s().value(), 4.95, 1e-9) << "not known yet whether it returns";
  EXPECT_FALSE(poses.at(5.1));
  add_with_steps(poses, 5.3, 10.0, step);
  EXPECT_FALSE(poses.at(4.97));
  ASSERT_TRUE(poses.at(5.1));
  EXPECT_NEAR(poses.at(5.1)->translation().x(), 42.55, 1e-9);
  EXPECT_NEAR(poses.at(4.9)->translation().x(), 2.45, 1e-9);
  EXPECT_EQ(poses.outliers(), 0U);
  const auto frames = poses.take_new_frames();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].source, "LOCAL_POSITION_NED");
  EXPECT_EQ(frames[0].quantity, NavQuantity::kPosition);
  EXPECT_NEAR(frames[0].step.moved_m, 40.025, 1e-9);
  EXPECT_NEAR(frames[0].step.to_s, 5.0, 1e-9);
  EXPECT_TRUE(poses.take_new_frames().empty()) << "said once";
}

TEST(LivePoses, AShortStayElsewhereIsNoNewFrame) {
  LivePoses poses;
  add_with_steps(poses, 0.0, 10.0, [](double time_s) { return time_s > 4.99 && time_s < 5.39 ? 40.0 : 0.0; });
  EXPECT_EQ(poses.outliers(), 8U);
  EXPECT_TRUE(poses.take_new_frames().empty());
  EXPECT_NEAR(poses.at(8.0).value().translation().x(), 4.0, 1e-9);
}

// The depth of fixes moves the path, too.
TEST(LivePoses, StepsOfTheDepthAreThoseOfThePath) {
  LivePoses poses;
  for (int i = 0; i < 200; ++i) {
    const double time_s = 0.1 * i, depth_m = i == 50 ? 30.0 : i < 100 ? 3.0 : -9.5;
    poses.add("ATTITUDE", NavQuantity::kAttitude, at(time_s, {0.0, 0.0, 1.0}));
    poses.add("GLOBAL_POSITION_INT", NavQuantity::kDepth, at(time_s, {depth_m, 0.0, 0.0}));
    poses.add("GLOBAL_POSITION_INT", NavQuantity::kFix, at(time_s, {0.9, 0.1, 0.0}));
  }
  EXPECT_EQ(poses.at(5.0).value().translation().z(), -3.0);
  EXPECT_EQ(poses.at(9.9).value().translation().z(), -3.0);
  EXPECT_EQ(poses.at(19.0).value().translation().z(), 9.5);
  const auto frames = poses.take_new_frames();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].quantity, NavQuantity::kDepth);
  EXPECT_NEAR(frames[0].step.moved_m, 12.5, 1e-9);
  for (double time_s = 10.0; time_s < 12.0; time_s += 0.05) {
    const double z_m = poses.at(time_s) ? poses.at(time_s)->translation().z() : -3.0;
    EXPECT_TRUE(z_m == -3.0 || z_m == 9.5) << time_s << ": " << z_m;
  }
}

TEST(LivePoses, ADeviceThatStartsAnewIsInANewFrame) {
  LivePoses poses;
  add_with_steps(poses, 0.0, 10.0, [](double) { return 5.0; });
  add_with_steps(poses, 15.0, 20.0, [](double time_s) { return -0.5 * time_s + 0.01 * (time_s - 15.0); });
  const auto frames = poses.take_new_frames();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].step.is_new_start);
  EXPECT_TRUE(poses.at(16.0));
}

// Made-up senders, as many as there are numbers for them, stopped the loop for 25 s.
TEST(LivePoses, AreNotStoppedByManySources) {
  LivePoses poses;
  for (int i = 0; i < 100'000; ++i) {
    const std::string name = "made up " + std::to_string(i);
    poses.add(name, NavQuantity::kAttitude, at(1e-5 * i, {0.0, 0.0, 1.0}));
    poses.add(name, NavQuantity::kPosition, at(1e-5 * i, {0.0, 0.0, 1.0}));
  }
  EXPECT_TRUE(poses.position().empty());
  add_with_steps(poses, 1.0, 5.0, [](double) { return 0.0; });
  EXPECT_EQ(poses.position(), "LOCAL_POSITION_NED");
  EXPECT_TRUE(poses.at(3.0));
}

}  // namespace
}  // namespace pingvox::test
