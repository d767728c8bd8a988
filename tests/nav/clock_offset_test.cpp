#include "pingvox/nav/clock_offset.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"
#include "tests/support/turning_vehicle.hpp"

namespace pingvox {
namespace {

using test::log_of;
using test::wander;
using test::Yaw;

TEST(ClockOffset, OfTwoLogsOfOneVehicle) {
  const auto changes = *yaw_changes(log_of(wander, 0.0, 300.0, 0.05, 0.0));
  ASSERT_GT(changes.size(), 290U);
  const auto offset = clock_offset(changes, log_of(wander, 100.0, 250.0, 0.1, -50.0));
  ASSERT_TRUE(offset) << offset.error().message;
  EXPECT_NEAR(offset->offset_s, 50.0, 0.005);
  EXPECT_LT(offset->deviation_s, 0.02);
}

// Kills steps that go on for ever, as a second is nothing beside such times.
TEST(ClockOffset, TimesThatStepsCannotMoveAreRefused) {
  const auto changes = yaw_changes(log_of(wander, 0.0, 90.0, 16.0, 1e17));
  ASSERT_FALSE(changes);
  EXPECT_NE(changes.error().message.find("thousands of years after 1970"), std::string::npos);
  const auto known = *yaw_changes(log_of(wander, 0.0, 90.0, 0.05, 0.0));
  EXPECT_FALSE(clock_offset(known, log_of(wander, 0.0, 90.0, 16.0, 1e17)));
}

std::filesystem::path shared(const std::string& name) {
  return std::filesystem::path(PINGVOX_SHARED_DATA) / name;
}

// By other means: UTC = 1712333650.395 + time since the start (the README of the recording).
TEST(ClockOffset, OfAnAutopilotAndItsGroundStation) {
  const auto tlog = shared("bluerov2-echosounder-nav/2024-04-05 09-19-03.tlog"),
             own = shared("bluerov2-echosounder-nav/00000124.BIN");
  if (!std::filesystem::exists(tlog) || !std::filesystem::exists(own)) GTEST_SKIP() << "no recording";
  const auto ground = read_nav(*read_file(tlog.string())), autopilot = read_nav(*read_file(own.string()));
  ASSERT_TRUE(ground && autopilot);
  const auto offset = clock_offset(*yaw_changes(ground->log), autopilot->log);
  ASSERT_TRUE(offset) << offset.error().message;
  EXPECT_NEAR(offset->offset_s, 1712333650.395, 0.02);
  EXPECT_LT(offset->deviation_s, 0.02);
}

// The same by the clock of the autopilot, which is in both.
TEST(NavClockOffset, OfAnAutopilotAndItsGroundStation) {
  const auto tlog = shared("bluerov2-echosounder-nav/2024-04-05 09-19-03.tlog"),
             later = shared("bluerov2-echosounder-nav/2024-04-05 09-25-32.tlog"),
             own = shared("bluerov2-echosounder-nav/00000124.BIN");
  if (!std::filesystem::exists(tlog) || !std::filesystem::exists(own)) GTEST_SKIP() << "no recording";
  const auto ground = read_nav(*read_file(tlog.string())), autopilot = read_nav(*read_file(own.string()));
  ASSERT_TRUE(ground && autopilot);
  const auto offset = nav_clock_offset(ground->log, ground->runs, autopilot->log);
  ASSERT_TRUE(offset) << offset.error().message;
  EXPECT_EQ(offset->by, NavClockOffset::By::kDevice);
  EXPECT_NEAR(offset->offset_s, 1712333650.395, 0.002);
  EXPECT_LT(offset->deviation_s, 0.01);
  // Without its messages.
  const auto by_turns = nav_clock_offset(ground->log, {}, autopilot->log);
  ASSERT_TRUE(by_turns) << by_turns.error().message;
  EXPECT_EQ(by_turns->by, NavClockOffset::By::kTurns);
  EXPECT_NEAR(by_turns->offset_s, 1712333650.395, 0.01);
  // Of another start, whose clock says times that the log has, too.
  const auto other = read_nav(*read_file(later.string()));
  ASSERT_TRUE(other);
  const auto of_other = nav_clock_offset(other->log, other->runs, autopilot->log);
  EXPECT_TRUE(!of_other || of_other->by == NavClockOffset::By::kTurns);
}

/// Turns of up to 130 degrees that last half a second, at uneven times, while the vehicle wanders.
double jerks(double time_s) {
  double yaw_rad = wander(time_s);
  for (int i = 0; i < 12; ++i) {
    const double share = std::clamp((time_s - (7.0 + 20.0 * i + 3.0 * std::sin(5.0 * i))) / 0.5, 0.0, 1.0);
    yaw_rad += (i % 2 == 0 ? 1.0 : -1.0) * (1.2 + 0.1 * i) * (3.0 - 2.0 * share) * share * share;
  }
  return yaw_rad;
}

/// Samples of a yaw, ten in a second, with a drift that is not in the other log.
NavLog drifting_log_of(const Yaw& yaw, double from_s, double to_s, double clock_s) {
  return log_of([&](double time_s) { return yaw(time_s) + 1e-3 * time_s + 2e-3 * std::sin(31.0 * time_s); }, from_s,
                to_s, 0.1, clock_s);
}

// Kills an offset that is tens of milliseconds off, by 7 degrees of a quick turn, and a device's clock that is taken
// though the log counts from another start.
TEST(NavClockOffset, OfShortAndQuickTurns) {
  constexpr double kStart_s = 1.6e9;
  const NavLog ground = log_of(jerks, 0.0, 260.0, 0.05, kStart_s + 40.0);
  for (const double phase_s : {0.0, 0.013, 0.05, 0.081}) {
    const NavLog own = drifting_log_of(jerks, 20.0 + phase_s, 240.0, 40.0);
    const auto by_turns = nav_clock_offset(ground, {}, own);
    ASSERT_TRUE(by_turns) << by_turns.error().message;
    EXPECT_NEAR(by_turns->offset_s, kStart_s, 0.006) << phase_s;
    const std::vector<DeviceRun> runs = {{kStart_s - 31.0, 0.006, kStart_s, kStart_s + 300.0},
                                         {kStart_s + 0.001, 0.006, kStart_s, kStart_s + 300.0}};
    const auto by_device = nav_clock_offset(ground, runs, own);
    ASSERT_TRUE(by_device) << by_device.error().message;
    EXPECT_EQ(by_device->by, NavClockOffset::By::kDevice);
    EXPECT_EQ(by_device->offset_s, kStart_s + 0.001);
    EXPECT_EQ(by_device->deviation_s, 0.006);
    const auto other_start = nav_clock_offset(ground, std::span(runs).first(1), own);
    ASSERT_TRUE(other_start) << other_start.error().message;
    EXPECT_EQ(other_start->by, NavClockOffset::By::kTurns);
  }
}

// Kills the border of the search, where the best offset of a slow turning is if it lies beyond, as the one that is
// told.
TEST(ClockError, AnOffsetBeyondTheWidestSearchIsNotTold) {
  const auto yaw = [](double time_s) {
    double sum = 0.0;
    for (double i = 0.0; i < 12.0; i += 1.0)
      sum += std::sin(2.0 * std::numbers::pi * time_s / (60.0 + 11.7 * i) + i * i);
    return 0.5 * sum;
  };
  std::vector<YawChange> changes;
  for (double time_s = 0.0; time_s < 1500.0; time_s += 2.0) {
    changes.push_back({time_s, time_s + 2.0, yaw(time_s + 2.0) - yaw(time_s), 0.5});
  }
  const auto late_by = [&](double late_s) {
    std::vector<StampedPose> poses;
    for (double time_s = -1000.0; time_s < 2500.0; time_s += 0.5) {
      poses.push_back({time_s + late_s, pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, yaw(time_s))});
    }
    return *Trajectory::make(poses);
  };
  const auto within = clock_error(changes, {}, late_by(590.0));
  ASSERT_TRUE(within);
  EXPECT_NEAR(within->offset_s, -590.0, 0.1);
  const auto beyond = clock_error(changes, {}, late_by(606.0));
  EXPECT_FALSE(beyond) << beyond->offset_s;
}

/// Of a yaw that changes by itself, and of a clock, in steps of two seconds.
class ClockJump : public testing::Test {
 protected:
  static constexpr double kJump_s = 200.0, kEnd_s = 400.0;

  /// What the sonar sees. @param ahead_s  by which its clock jumps, @param pause_s  for which the head stops
  static std::vector<YawChange> changes(double ahead_s, double pause_s, const Yaw& yaw = wander) {
    std::vector<YawChange> all;
    const auto clock = [&](double time_s) { return time_s + (time_s > kJump_s ? ahead_s : 0.0); };
    for (double time_s = 0.0; time_s < kEnd_s; time_s += 2.0) {
      if (time_s > kJump_s && time_s < kJump_s + pause_s) continue;
      const double next_s = time_s == kJump_s && pause_s > 0.0 ? kJump_s + pause_s + 1.0 : time_s + 2.0;
      all.push_back({clock(time_s), clock(next_s), yaw(next_s) - yaw(time_s), 0.5});
    }
    return all;
  }
  static std::vector<TimeSpan> pause_of(double length_s) { return {{kJump_s, kJump_s + length_s}}; }
  static Trajectory poses(double ahead_s, double pause_s, const Yaw& yaw = wander) {
    std::vector<StampedPose> all;
    for (double time_s = 0.0; time_s < kEnd_s + 100.0; time_s += 0.5) {
      if (time_s > kJump_s && time_s < kJump_s + pause_s) continue;
      const double clock_s = time_s + (time_s > kJump_s ? ahead_s : 0.0);
      all.push_back({clock_s, pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, yaw(time_s))});
    }
    return *Trajectory::make(all);
  }
};

// Kills a check that takes all of a log together: the part before a jump and the part after it tell two offsets.
TEST_F(ClockJump, OfThePosesIsTold) {
  for (const double ahead_s : {3.0, 10.0, 25.0}) {
    const auto error = clock_error(changes(0.0, 0.0), {}, poses(ahead_s, 0.0));
    ASSERT_TRUE(error && error->from_s) << ahead_s;
    EXPECT_NEAR(error->offset_s, -ahead_s, 0.2);
    EXPECT_NEAR(*error->from_s, kJump_s + ahead_s, 1.0);
    EXPECT_TRUE(error->is_apart());
  }
}

TEST_F(ClockJump, OfTheSonarIsTold) {
  for (const double ahead_s : {10.0, 90.0}) {
    const auto error = clock_error(changes(ahead_s, 0.0), pause_of(ahead_s), poses(0.0, 0.0));
    ASSERT_TRUE(error && error->from_s) << ahead_s;
    EXPECT_NEAR(error->offset_s, ahead_s, 0.2);
    EXPECT_NEAR(*error->from_s, kJump_s + ahead_s, 1.0);
  }
}

// Kills a pause that is taken for a jump.
TEST_F(ClockJump, IsNoPause) {
  for (const auto& error : {clock_error(changes(0.0, 0.0), {}, poses(0.0, 25.0)),
                            clock_error(changes(0.0, 25.0), pause_of(25.0), poses(0.0, 0.0)),
                            clock_error(changes(0.0, 25.0), pause_of(25.0), poses(0.0, 20.0))}) {
    ASSERT_TRUE(error);
    EXPECT_FALSE(error->from_s) << error->offset_s;
    EXPECT_FALSE(error->is_apart()) << error->offset_s;
  }
}

// Kills a jump that explains the turning no better than the pause.
TEST_F(ClockJump, IsNoPauseAfterWhichTheVehicleTurnsAsBefore) {
  const Yaw again = [](double time_s) { return 0.6 * std::sin(2.0 * std::numbers::pi * time_s / 25.0); };
  const auto error = clock_error(changes(0.0, 0.0, again), {}, poses(0.0, 25.0, again));
  EXPECT_FALSE(error && error->from_s);
}

}  // namespace
}  // namespace pingvox
