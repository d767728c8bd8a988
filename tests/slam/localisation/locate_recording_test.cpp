// A whole recording in a room whose map is known.

#include "pingvox/slam/locate_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/room.hpp"
#include "tests/support/turning_vehicle.hpp"

namespace pingvox::test {
namespace {

constexpr Room::State kStart = {-1.0, 0.5, 0.7};

DistanceField field_of(const Room& room) {
  return *DistanceField::make(room.map(), {});
}

std::vector<Beam> beams_at(const Room& room, const Room::State& place, int count) {
  std::vector<Beam> beams;
  for (int i = 0; i < count; ++i) beams.push_back(room.beam(i, place));
  return beams;
}

LocatedRecording located(const Room& room, Estimation estimation) {
  LocateOptions options;
  options.estimation = estimation;
  const auto found = locate_recording(beams_at(room, kStart, 300), {}, field_of(room), options);
  EXPECT_TRUE(found) << found.error().message;
  return *found;
}

// Kills poses that are taken for known before anything said so, and ones that are not known once it did.
TEST(LocateRecording, KnowsThePosesBeforeASureOneOnlyWhenAllIsRecorded) {
  const Room room;
  const LocatedRecording batch = located(room, Estimation::kBatch), causal = located(room, Estimation::kCausal);
  ASSERT_EQ(batch.poses.size(), causal.poses.size());
  EXPECT_TRUE(batch.is_sure());
  EXPECT_FALSE(batch.poses.front().was_sure);
  EXPECT_TRUE(std::ranges::all_of(batch.poses, &LocatedPose::is_known));
  EXPECT_TRUE(std::ranges::all_of(causal.poses, [](const LocatedPose& p) { return p.is_known == p.was_sure; }));
  EXPECT_EQ(causal.known_trajectory()->poses().size(),
            static_cast<std::size_t>(std::ranges::count(causal.poses, true, &LocatedPose::was_sure)));
  EXPECT_EQ(batch.trajectory()->poses().size(), batch.poses.size());
}

// Kills poses that count as known however many places fit.
TEST(LocateRecording, KnowsNoPoseWhereTwoPlacesFit) {
  const LocatedRecording found = located(Room{.has_block = false}, Estimation::kBatch);
  EXPECT_EQ(found.hypotheses.size(), 2U);
  EXPECT_TRUE(std::ranges::none_of(found.poses, &LocatedPose::is_known));
  EXPECT_FALSE(found.known_trajectory());
}

// Kills a sure place that is taken to confirm where the vehicle was before it was carried away.
TEST(LocateRecording, APoseBeforeAJumpIsNotKnownByOneBehindIt) {
  const Room room;
  constexpr int kJump = 150;  // found after one turn of the head, sure after two
  const double ahead_m = 0.9;
  const Room::State there = {kStart.x + ahead_m * std::cos(kStart.yaw), kStart.y + ahead_m * std::sin(kStart.yaw),
                             kStart.yaw};
  std::vector<Beam> beams;
  std::vector<StampedPose> odometry;
  for (int i = 0; i < 500; ++i) {
    beams.push_back(room.beam(i, i < kJump ? kStart : there));
    odometry.push_back({0.1 * i, Pose(Eigen::Translation3d(i < kJump ? 0.0 : ahead_m, 0.0, 0.0))});
  }
  RecordedMotion motion;
  motion.odometry_from_body = *Trajectory::make(std::move(odometry));
  const auto found = locate_recording(std::move(beams), motion, field_of(room), {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT(found->poses.front().time_s, 0.1 * kJump);
  EXPECT_FALSE(found->poses.front().is_known);
  EXPECT_TRUE(found->is_sure());
  EXPECT_TRUE(found->poses.back().is_known);
}

// Kills a place that counts as known on both sides of a turn that the filter did not follow.
TEST(LocateRecording, APoseBeforeATurnAtOnceIsNotKnownByOneBehindIt) {
  const Room room;
  constexpr int kTurn = 150;  // found after one turn of the head, sure after two
  const Room::State there = {kStart.x, kStart.y, kStart.yaw + 2.0};
  std::vector<Beam> beams;
  std::vector<StampedPose> odometry;
  for (int i = 0; i < 500; ++i) {
    beams.push_back(room.beam(i, i < kTurn ? kStart : there));
    odometry.push_back({0.1 * i, pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, i < kTurn ? 0.0 : 2.0)});
  }
  RecordedMotion motion;
  motion.odometry_from_body = *Trajectory::make(std::move(odometry));
  const auto found = locate_recording(std::move(beams), motion, field_of(room), {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT(found->poses.front().time_s, 0.1 * kTurn);
  EXPECT_FALSE(found->poses.front().is_known);
  EXPECT_TRUE(found->poses.back().is_known);
}

// Kills poses that count as known since the filter has not noticed yet that it is wrong.
TEST(LocateRecording, NoPoseIsKnownWhereATurnInPlaceIsNotNoticedYet) {
  const Room room;
  constexpr int kTurn = 400;
  std::vector<Beam> beams;
  for (int i = 0; i < 900; ++i) {
    beams.push_back(room.beam(i, {kStart.x, kStart.y, i < kTurn ? kStart.yaw : kStart.yaw + 2.0}));
  }
  const auto found = locate_recording(std::move(beams), {}, field_of(room), {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->poses.front().is_known);
  EXPECT_TRUE(found->poses.back().is_known);
  for (const LocatedPose& pose : found->poses) {
    const double yaw_rad = pose.time_s < 0.1 * kTurn ? kStart.yaw : kStart.yaw + 2.0;
    const double off_rad = std::remainder(rpy_of(pose.map_from_body.rotation()).z() - yaw_rad, 2.0 * std::numbers::pi);
    EXPECT_FALSE(pose.is_known && std::abs(off_rad) > 0.2) << pose.time_s;
  }
}

/// Round the middle of the room in 80 seconds, heading along the way.
Room::State state_at(double time_s) {
  const double angle = 2.0 * std::numbers::pi * time_s / 80.0;
  return {-0.3 + std::cos(angle), -0.3 + std::sin(angle), angle + std::numbers::pi / 2.0};
}

double located_error_m(const LocatedRecording& found) {
  double squares = 0.0;
  for (const LocatedPose& pose : found.poses) {
    const Room::State truth = state_at(pose.time_s);
    const Eigen::Vector3d at = pose.map_from_body.translation();
    squares += std::pow(at.x() - truth.x, 2) + std::pow(at.y() - truth.y, 2);
  }
  return std::sqrt(squares / static_cast<double>(found.poses.size()));
}

std::vector<Beam> beams_around(const Room& room) {
  std::vector<Beam> beams;
  for (int i = 0; i < 800; ++i) beams.push_back(room.beam(i, state_at(0.1 * i)));
  return beams;
}

/// What navigation says of the way round, with a velocity that is 20 % too large.
RecordedMotion motion_around(double from_s) {
  NavSource velocity{"dvl", NavQuantity::kVelocity, {}, {}}, heading{"imu", NavQuantity::kAttitude, {}, {}};
  for (double time_s = from_s; time_s < 81.0; time_s += 0.25) {
    velocity.samples.push_back({.time_s = time_s, .value = {1.2 * 2.0 * std::numbers::pi / 80.0, 0.0, 0.0}});
    heading.samples.push_back(
        {.time_s = time_s, .value = {0.0, 0.0, std::remainder(state_at(time_s).yaw, 2.0 * std::numbers::pi)}});
  }
  RecordedMotion motion;
  motion.nav = *NavLog::make({velocity, heading}, NavClock::kUnknown);
  motion.odometry_from_body = odometry_of(*motion.nav, motion.nav_options)->odometry_from_body;
  return motion;
}

// Kills a smoother that is not asked, or whose poses are not taken: a wrong velocity leads the filter.
TEST(LocateRecording, VelocitiesSmoothThePosesOfTheFilter) {
  const Room room;
  std::vector<Beam> beams = beams_around(room);
  const RecordedMotion motion = motion_around(-0.5);
  LocateOptions options;
  options.start = StartPose{state_at(0.0).x, state_at(0.0).y, state_at(0.0).yaw};

  double done = 0.0;
  const auto smoothed = locate_recording(beams, motion, field_of(room), options, [&](double share) { done = share; });
  ASSERT_TRUE(smoothed) << smoothed.error().message;
  options.estimation = Estimation::kCausal;
  const auto causal = locate_recording(std::move(beams), motion, field_of(room), options);
  ASSERT_TRUE(causal) << causal.error().message;
  EXPECT_GT(done, 0.99);
  EXPECT_TRUE(std::ranges::all_of(smoothed->poses, &LocatedPose::is_smoothed));
  EXPECT_TRUE(std::ranges::none_of(causal->poses, &LocatedPose::is_smoothed));
  EXPECT_LT(located_error_m(*smoothed), 0.05);
  EXPECT_LT(located_error_m(*smoothed), 0.7 * located_error_m(*causal));
}

// Kills a wrong start that counts as known until the navigation begins, because the map fits ever after.
TEST(LocateRecording, WhatIsBeforeTheNavigationIsNotKnownByWhatComesLater) {
  const Room room;
  LocateOptions options;
  options.start = StartPose{state_at(0.0).x + 0.4, state_at(0.0).y, state_at(0.0).yaw};
  const auto found = locate_recording(beams_around(room), motion_around(3.0), field_of(room), options);
  ASSERT_TRUE(found) << found.error().message;
  for (const LocatedPose& pose : found->poses) {
    EXPECT_EQ(pose.is_smoothed, pose.time_s >= 3.0) << pose.time_s;
    EXPECT_EQ(pose.is_known, pose.is_smoothed || pose.was_sure) << pose.time_s;
  }
  EXPECT_FALSE(found->poses.front().is_known);
}

// Kills an odometry on another clock that is followed without a word, and an offset of the wrong sign.
TEST(LocateRecording, ChecksTheClockOfTheOdometry) {
  const Room room;
  for (const double late_s : {0.0, 4.0}) {
    std::vector<Beam> beams;
    std::vector<StampedPose> odometry;
    for (int i = 0; i < 900; ++i) {
      const double yaw_rad = wander(0.1 * i);
      beams.push_back(room.beam(i, {kStart.x, kStart.y, yaw_rad}));
      odometry.push_back({0.1 * i + late_s, pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, yaw_rad)});
    }
    RecordedMotion motion;
    motion.odometry_from_body = *Trajectory::make(std::move(odometry));
    const auto found = locate_recording(std::move(beams), motion, field_of(room), {});
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_TRUE(found->clock_check) << late_s;
    EXPECT_NEAR(found->clock_check->offset_s, -late_s, 0.3);
    EXPECT_EQ(found->clock_check->is_apart(), late_s != 0.0);
  }
}

TEST(LocateRecording, RefusesTimesThatRunBackwards) {
  const Room room;
  std::vector<Beam> beams = beams_at(room, kStart, 3);
  std::swap(beams[0], beams[2]);
  const auto found = locate_recording(std::move(beams), {}, field_of(room), {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Error::Code::kCorrupt);
}

}  // namespace
}  // namespace pingvox::test
