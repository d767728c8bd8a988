#include "pingvox/sim/vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pingvox/geometry/pose2.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

TEST(FollowRoute, GoesThroughItsWaypointsAtItsSpeedAndLooksAhead) {
  const Route route{{{0.0, 0.0, -1.0}, {4.0, 0.0, -1.0}, {4.0, 4.0, -2.0}}, Route::End::kStays};
  const Trajectory way = follow_route(route, 60.0, {.speed_m_s = 0.5, .pose_every_s = 0.1});
  EXPECT_EQ(way.poses().front().time_s, 0.0);
  EXPECT_GE(way.poses().back().time_s, 60.0);
  for (const Vector3d& waypoint : route.waypoints_m) {
    double nearest = 1e9;
    for (const auto& pose : way.poses()) {
      nearest = std::min(nearest, (pose.map_from_body.translation() - waypoint).norm());
    }
    EXPECT_LT(nearest, 0.06) << waypoint.transpose();
  }
  const double arrived_s = length_m(route) / 0.5;
  std::size_t steps = 0;
  for (std::size_t n = 1; n < way.poses().size(); ++n) {
    const Vector3d step = way.poses()[n].map_from_body.translation() - way.poses()[n - 1].map_from_body.translation();
    if (way.poses()[n].time_s < arrived_s) {
      EXPECT_NEAR(step.norm(), 0.05, 0.003);
      const double error =
          std::remainder(std::atan2(step.y(), step.x()) - yaw_of(way.poses()[n].map_from_body), 2.0 * std::numbers::pi);
      EXPECT_NEAR(error, 0.0, 0.2);
      ++steps;
    }
  }
  EXPECT_GT(steps, 150U);
  EXPECT_TRUE(way.poses().back().map_from_body.translation().isApprox(route.waypoints_m.back())) << "it stays";
}

TEST(FollowRoute, GoesRoundAndRound) {
  const Route route{{{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {4.0, 4.0, 0.0}, {0.0, 4.0, 0.0}}, Route::End::kStarts};
  const double round_s = length_m(route) / 0.5;
  const Trajectory way = follow_route(route, 3.0 * round_s, {.speed_m_s = 0.5});
  for (const double time : {1.0, 7.0, 20.0}) {
    const Pose first = *way.at(time);
    const Pose later = *way.at(time + 2.0 * round_s);
    EXPECT_LT((first.translation() - later.translation()).norm(), 0.02) << time;
  }
}

TEST(DriveByHand, StopsTurnsAndComesToTheEndNearItsRoute) {
  const Route route{{{0.0, 0.0, 0.0}, {60.0, 0.0, 0.0}, {60.0, 60.0, 0.0}, {0.0, 60.0, 0.0}}, Route::End::kStarts};
  const Trajectory path = follow_route(route, length_m(route), {.speed_m_s = 1.0});
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    const Trajectory way = drive_by_hand(route, {.speed_m_s = 0.5}, seed);
    const auto& poses = way.poses();
    EXPECT_NEAR((poses.back().map_from_body.translation() - route.waypoints_m[0]).norm(), 0.0, 1.0);
    // Some tenths of the time are for stops.
    EXPECT_GT(poses.back().time_s, 1.0 * length_m(route) / 0.5);
    EXPECT_LT(poses.back().time_s, 2.0 * length_m(route) / 0.5);
    double hovers_s = 0.0, fastest_rad_s = 0.0, farthest_m = 0.0;
    for (std::size_t n = 4; n < poses.size(); n += 4) {
      const Pose step = poses[n - 4].map_from_body.inverse() * poses[n].map_from_body;
      if (step.translation().norm() < 0.1) hovers_s += 1.0;
      fastest_rad_s = std::max(fastest_rad_s, std::abs(yaw_of(step)));
      double nearest = 1e9;
      for (const StampedPose& on : path.poses()) {
        nearest = std::min(nearest, (on.map_from_body.translation() - poses[n].map_from_body.translation()).norm());
      }
      farthest_m = std::max(farthest_m, nearest);
    }
    EXPECT_GT(hovers_s, 15.0);
    EXPECT_GT(fastest_rad_s, 0.4) << "sudden turns";
    EXPECT_LT(fastest_rad_s, 1.2);
    EXPECT_LT(farthest_m, 0.7) << "sway alone";
  }
}

TEST(DriveByHand, SwaysByATenthOfAMetre) {
  const Route route{{{0.0, 0.0, 0.0}, {500.0, 0.0, 0.0}}, Route::End::kStays};
  const Trajectory way = drive_by_hand(route, {.speed_m_s = 0.25}, 7);
  double squares = 0.0;
  for (const StampedPose& pose : way.poses()) squares += std::pow(pose.map_from_body.translation().y(), 2.0);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(way.poses().size())), 0.1, 0.02);
  const Trajectory again = drive_by_hand(route, {.speed_m_s = 0.25}, 7);
  EXPECT_EQ(way.poses().back().map_from_body.matrix(), again.poses().back().map_from_body.matrix());
}

TEST(AddDrift, IsTheTruthWithoutDrift) {
  const Route route{{{0.0, 0.0, 0.0}, {4.0, 1.0, 0.0}, {4.0, 4.0, -1.0}}, Route::End::kStays};
  const Trajectory truth = follow_route(route, 40.0, {});
  const Trajectory told = add_drift(truth, {});
  ASSERT_EQ(told.poses().size(), truth.poses().size());
  for (std::size_t n = 0; n < truth.poses().size(); ++n) {
    EXPECT_TRUE(told.poses()[n].map_from_body.isApprox(truth.poses()[n].map_from_body, 1e-12)) << n;
  }
}

TEST(AddDrift, StraysAsFarAsOrdered) {
  // Standing still for a minute: the walk's end has the deviation that was asked for, along x and y and in heading.
  std::vector<StampedPose> poses;
  for (int n = 0; n <= 240; ++n) poses.push_back({0.25 * n, Pose(Eigen::Translation3d(1.0, 2.0, 3.0))});
  const Trajectory truth = *Trajectory::make(poses);
  double xx = 0.0, yy = 0.0, hh = 0.0, sum = 0.0;
  constexpr int kWalks = 400;
  for (int seed = 0; seed < kWalks; ++seed) {
    const Trajectory told =
        add_drift(truth, {.seed = static_cast<std::uint64_t>(seed), .position_m = 0.5, .heading_rad = 0.1});
    EXPECT_TRUE(told.poses().front().map_from_body.isApprox(truth.poses().front().map_from_body)) << "it starts true";
    const Vector3d off = told.poses().back().map_from_body.translation() - Vector3d(1.0, 2.0, 3.0);
    const double heading = yaw_of(told.poses().back().map_from_body);
    EXPECT_EQ(off.z(), 0.0) << "depth is measured";
    xx += off.x() * off.x() / kWalks;
    yy += off.y() * off.y() / kWalks;
    hh += heading * heading / kWalks;
    sum += off.x() / kWalks;
  }
  // Deviations of 400 walks are known to 3.5 %: four of these.
  EXPECT_NEAR(std::sqrt(xx), 0.5, 0.07);
  EXPECT_NEAR(std::sqrt(yy), 0.5, 0.07);
  EXPECT_NEAR(std::sqrt(hh), 0.1, 0.014);
  EXPECT_NEAR(sum, 0.0, 0.1) << "to no side";
}

TEST(AddDrift, AWrongHeadingTurnsTheWayOn) {
  const Route route{{{0.0, 0.0, 0.0}, {30.0, 0.0, 0.0}}, Route::End::kStays};
  const Trajectory truth = follow_route(route, 60.0, {.speed_m_s = 0.5});
  const Trajectory told = add_drift(truth, {.seed = 3, .heading_rad = 0.3});
  const Pose end = told.poses().back().map_from_body;
  EXPECT_GT(std::abs(end.translation().y()), 0.2);
  // Each step is as long as the true one.
  for (std::size_t n = 1; n < told.poses().size(); ++n) {
    const auto step = [n](const Trajectory& way) {
      return (way.poses()[n].map_from_body.translation() - way.poses()[n - 1].map_from_body.translation()).norm();
    };
    EXPECT_NEAR(step(told), step(truth), 1e-9);
  }
}

TEST(Options, OfVehiclesNameEveryBrokenField) {
  EXPECT_TRUE(TravelOptions{}.validate());
  EXPECT_TRUE(DriftOptions{}.validate());
  const std::string travel = TravelOptions{.speed_m_s = 0.0, .pose_every_s = -1.0}.validate().error().message;
  EXPECT_NE(travel.find("speed_m_s"), std::string::npos);
  EXPECT_NE(travel.find("pose_every_s"), std::string::npos);
  const std::string drift = DriftOptions{.position_m = -1.0, .heading_rad = 11.0}.validate().error().message;
  EXPECT_NE(drift.find("position_m"), std::string::npos);
  EXPECT_NE(drift.find("heading_rad"), std::string::npos);
}

}  // namespace
}  // namespace pingvox
