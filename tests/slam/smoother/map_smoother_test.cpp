// All of a recording in a map that is known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/random.hpp"
#include "pingvox/map/distance_field.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "support/room.hpp"

namespace pingvox::test {
namespace {

/// Round the middle of the room in 80 seconds, heading along the way.
Room::State circling_at(double time_s) {
  const double angle = 2.0 * std::numbers::pi * time_s / 80.0;
  return {-0.3 + std::cos(angle), -0.3 + std::sin(angle), angle + std::numbers::pi / 2.0};
}

constexpr int kBeams = 800;
constexpr double kVelocityYaw_rad = 6.0 * kDegree_rad;

/// By a DVL that is turned and noisy, and a compass whose north is not that of the map, and that deviates.
SlamSmoother recorded(const Room& room) {
  Random random(1);
  SlamSmoother smoother({});
  for (int i = 0; i < kBeams; ++i) smoother.add(room.beam(i, circling_at(0.1 * i)));
  const double speed_m_s = 2.0 * std::numbers::pi / 80.0;
  for (double time_s = -0.5; time_s < 81.0; time_s += 0.25) {
    NavSample sample;
    sample.time_s = time_s;
    sample.value = {speed_m_s * std::cos(kVelocityYaw_rad) + 0.02 * random.normal(),
                    -speed_m_s * std::sin(kVelocityYaw_rad) + 0.02 * random.normal(), 0.0};
    EXPECT_TRUE(smoother.add("dvl", NavQuantity::kVelocity, sample));
    const double yaw_rad = circling_at(time_s).yaw;
    sample.value = {0.0, 0.0, std::remainder(yaw_rad + 1.2 + 0.08 * std::sin(yaw_rad), 2.0 * std::numbers::pi)};
    EXPECT_TRUE(smoother.add("imu", NavQuantity::kAttitude, sample));
  }
  return smoother;
}

/// The truth, but this far off.
Trajectory near_truth(double x_m, double y_m, double yaw_rad) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < kBeams; ++i) {
    const Room::State at = circling_at(0.1 * i);
    poses.push_back({0.1 * i, pose_from_rpy({at.x + x_m, at.y + y_m, 0.0}, 0.0, 0.0, at.yaw + yaw_rad)});
  }
  return *Trajectory::make(std::move(poses));
}

// Kills a derivative with a wrong sign, a calibration that is not learnt, and a frame that begins at 0, 0.
TEST(MapSmoother, FindsTheTrajectoryInTheMapAndHowTheVelocityIsTurned) {
  const Room room;
  const SlamSmoother smoother = recorded(room);
  const auto solution = smoother.solve_in(*DistanceField::make(room.map(), {}), near_truth(0.2, -0.15, 0.1));
  ASSERT_TRUE(solution) << solution.error().message;
  double squares = 0.0;
  for (const StampedPose& pose : solution->trajectory.poses()) {
    const Room::State truth = circling_at(pose.time_s);
    const Eigen::Vector3d at = pose.map_from_body.translation(), ahead = pose.map_from_body.rotation().col(0);
    squares += std::pow(at.x() - truth.x, 2) + std::pow(at.y() - truth.y, 2);
    EXPECT_NEAR(std::remainder(std::atan2(ahead.y(), ahead.x()) - truth.yaw, 2.0 * std::numbers::pi), 0.0,
                1.5 * kDegree_rad);
  }
  EXPECT_EQ(solution->trajectory.poses().size(), std::size_t{kBeams});
  EXPECT_LT(std::sqrt(squares / kBeams), 0.03);
  EXPECT_NEAR(solution->calibration.velocity_yaw_rad.value, kVelocityYaw_rad, 2.0 * kDegree_rad);
  EXPECT_GT(solution->least_on_walls, 0.8);
}

// Kills a solution that is taken wherever it ends.
TEST(MapSmoother, RefusesPosesWhereTheMapDoesNotFit) {
  const Room room;
  const SlamSmoother smoother = recorded(room);
  const auto solution = smoother.solve_in(*DistanceField::make(room.map(), {}), near_truth(1.5, -1.0, 1.5));
  ASSERT_FALSE(solution);
  EXPECT_THAT(solution.error().message, testing::HasSubstr("do not fit the map"));
}

}  // namespace
}  // namespace pingvox::test
