#include "pingvox/nav/trajectory_score.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace pingvox {
namespace {

StampedPose pose_at(double time_s, double x, double y, double z = 0.0) {
  return {time_s, pose_from_rpy({x, y, z}, 0, 0, 0)};
}

/// A figure that is nowhere near symmetric: 100 m ahead, then 50 m to the left, a metre a second.
std::vector<StampedPose> hook() {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 150; ++i) poses.push_back(pose_at(i, std::min(i, 100), std::max(i - 100, 0)));
  return poses;
}

TrajectoryScore score_of(std::vector<StampedPose> ours, std::vector<StampedPose> reference) {
  const auto score = score_trajectory(*Trajectory::make(std::move(ours)), *Trajectory::make(std::move(reference)));
  EXPECT_TRUE(score) << score.error().message;
  return *score;
}

TEST(TrajectoryScore, OfARotatedAndShiftedCopyIsZeroOnlyAfterRigidAlignment) {
  const double turn_rad = 0.1;
  const Pose moved = pose_from_rpy({500, -300, 2}, 0, 0, turn_rad);
  std::vector<StampedPose> turned = hook();
  for (StampedPose& pose : turned) pose.map_from_body = moved * pose.map_from_body;
  const TrajectoryScore score = score_of(turned, hook());

  EXPECT_EQ(score.poses, 151U);
  EXPECT_NEAR(score.se2_turn_rad, -turn_rad, 1e-12);
  EXPECT_NEAR(score.se2.max_m, 0.0, 1e-9);
  EXPECT_NEAR(score.per_m, 0.0, 1e-12);
  // A point at distance r of the centre of a turn moves by its chord; the farthest is the end of the hook.
  const double chord = 2.0 * std::sin(turn_rad / 2.0);
  EXPECT_NEAR(score.first_fix.max_m, chord * std::hypot(100, 50), 1e-9);
  // About the mean: 101 points at y 0, of mean x 50, and 50 at x 100, of mean y 25.5.
  const double x = (101 * 50 + 50 * 100) / 151.0, y = 50 * 25.5 / 151.0;
  EXPECT_NEAR(score.translation.max_m, chord * std::hypot(x, y), 1e-9);
}

TEST(TrajectoryScore, ShiftsTheFirstFixByTheFirstPairAloneAndTheTranslationByTheMean) {
  const TrajectoryScore score = score_of({pose_at(0, 1, 0), pose_at(1, 10, 0), pose_at(2, 20, 3)},
                                         {pose_at(0, 0, 0), pose_at(1, 10, 0), pose_at(2, 20, 0)});
  // Differences (1, 0), (0, 0), (0, 3); from the first (0, 0), (-1, 0), (-1, 3).
  EXPECT_NEAR(score.first_fix.mean_m, (1 + std::sqrt(10)) / 3, 1e-12);
  EXPECT_NEAR(score.first_fix.rmse_m, std::sqrt(11.0 / 3), 1e-12);
  EXPECT_NEAR(score.first_fix.max_m, std::sqrt(10), 1e-12);
  EXPECT_NEAR(score.first_fix.sd_m,
              std::sqrt(std::pow(score.first_fix.rmse_m, 2) - std::pow(score.first_fix.mean_m, 2)), 1e-12);
  // From the mean (1/3, 1): (2/3, -1), (-1/3, -1), (-1/3, 2).
  EXPECT_NEAR(score.translation.rmse_m, std::sqrt((4 + 9 + 1 + 9 + 1 + 36) / 9.0 / 3.0), 1e-12);
  // As they are: (1, 0), (0, 0), (0, 3).
  EXPECT_NEAR(score.none.mean_m, 4.0 / 3, 1e-12);
  EXPECT_NEAR(score.none.rmse_m, std::sqrt(10.0 / 3), 1e-12);
  EXPECT_LE(score.se2.rmse_m, score.translation.rmse_m);
  EXPECT_NEAR(score.max_difference_m, 3.0, 1e-12);
}

TEST(TrajectoryScore, InterpolatesAtTheTimesOfTheReferenceAndCountsThoseOutside) {
  const TrajectoryScore score =
      score_of({pose_at(0, 0, 0), pose_at(10, 10, 0)},
               {pose_at(-1, 0, 0), pose_at(2.5, 2.5, 0), pose_at(9, 9, 0), pose_at(11, 0, 0)});
  EXPECT_EQ(score.poses, 2U);
  EXPECT_EQ(score.outside, 2U);
  EXPECT_NEAR(score.first_fix.max_m, 0.0, 1e-12);
}

TEST(TrajectoryScore, UsesNeitherTheHeadingsNorTheHeightsOfTheReference) {
  std::vector<StampedPose> reference = hook();
  for (StampedPose& pose : reference) pose.map_from_body = pose.map_from_body * pose_from_rpy({0, 0, 7}, 1, 0, 2);
  const TrajectoryScore score = score_of(hook(), reference);
  EXPECT_NEAR(score.first_fix.max_m, 0.0, 1e-12);
  EXPECT_NEAR(score.se2_turn_rad, 0.0, 1e-12);
  EXPECT_NEAR(score.max_difference_m, 7.0, 1e-12) << "but they are not the same";
}

TEST(TrajectoryScore, OfNoiseIsItsSize) {
  const int count = 20000;
  const double sigma_m = 0.3;
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, sigma_m);
  std::vector<StampedPose> ours, reference;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    reference.push_back(pose_at(i, 50 * std::cos(angle), 30 * std::sin(2 * angle)));
    ours.push_back(pose_at(i, reference.back().map_from_body.translation().x() + noise(random),
                           reference.back().map_from_body.translation().y() + noise(random)));
  }
  const TrajectoryScore score = score_of(ours, reference);
  // Distances have Rayleigh's distribution. Five standard deviations of these means: 0.007.
  EXPECT_NEAR(score.se2.mean_m, sigma_m * std::sqrt(std::numbers::pi / 2), 0.01);
  EXPECT_NEAR(score.se2.rmse_m, sigma_m * std::sqrt(2.0), 0.01);
  EXPECT_NEAR(score.se2.sd_m, sigma_m * std::sqrt(2 - std::numbers::pi / 2), 0.01);
  // A displacement has the noise of both its ends.
  EXPECT_NEAR(score.per_m * score.segment_m, 2 * sigma_m, 0.02);
}

TEST(TrajectoryScore, OfAScaleErrorIsThatScalePerMetre) {
  std::vector<StampedPose> ours, reference;
  for (int i = 0; i <= 100; ++i) {
    reference.push_back(pose_at(i, i, 0));
    ours.push_back(pose_at(i, 1.02 * i, 0));
  }
  const TrajectoryScore score = score_of(ours, reference);
  EXPECT_NEAR(score.per_m, 0.02, 1e-12);
  EXPECT_NEAR(score.segment_m, 10.0, 1e-12);
}

TEST(TrajectoryScore, OfWhatStandsStillOrIsNeverKnownTogether) {
  const TrajectoryScore still = score_of({pose_at(0, 1, 1), pose_at(5, 1, 1)}, {pose_at(1, 0, 0), pose_at(2, 0, 0)});
  EXPECT_EQ(still.se2.max_m, 0.0);
  EXPECT_EQ(still.se2_turn_rad, 0.0);
  EXPECT_TRUE(std::isnan(still.per_m));
  EXPECT_FALSE(score_trajectory(*Trajectory::make({pose_at(0, 0, 0)}), *Trajectory::make({pose_at(1, 0, 0)})));
}

}  // namespace
}  // namespace pingvox
