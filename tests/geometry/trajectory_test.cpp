#include "pingvox/geometry/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace pingvox;

namespace {

constexpr double kPi = 3.14159265358979323846;

Pose pose_with_yaw(double x_m, double yaw_rad) {
  return pose_from_rpy({x_m, 0.0, 0.0}, 0.0, 0.0, yaw_rad);
}

TEST(Pose, TurnsRollThenPitchThenYawAboutFixedAxes) {
  const Pose pose = pose_from_rpy({1.0, 2.0, 3.0}, kPi / 2, 0.0, kPi / 2);
  // Roll brings y to z; yaw leaves z alone and brings x to y.
  EXPECT_TRUE((pose * Eigen::Vector3d(0, 1, 0)).isApprox(Eigen::Vector3d(1, 2, 4), 1e-12));
  EXPECT_TRUE((pose * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3), 1e-12));
  // A positive pitch lowers the bow.
  EXPECT_LT((pose_from_rpy({0, 0, 0}, 0.0, 0.1, 0.0) * Eigen::Vector3d(1, 0, 0)).z(), 0.0);
}

// Kills angles of other axes or of another order; both ends of the pitch are there.
TEST(Pose, AnglesOfARotationAreThoseItWasMadeOf) {
  for (const double roll : {-3.0, -0.4, 0.0, 2.1}) {
    for (const double pitch : {-1.5, 0.3, 1.5}) {
      for (const double yaw : {-2.9, 0.0, 0.7, 3.1}) {
        const Eigen::Vector3d rpy = rpy_of(pose_from_rpy({1, 2, 3}, roll, pitch, yaw).linear());
        EXPECT_TRUE(rpy.isApprox(Eigen::Vector3d(roll, pitch, yaw), 1e-9)) << rpy.transpose();
      }
    }
  }
  for (const double pitch : {-kPi / 2, kPi / 2}) {
    // Roll and yaw are one turn there, and rounding must not leave the range of asin.
    const Eigen::Matrix3d rotation = pose_from_rpy({0, 0, 0}, 0.3, pitch, 1.2).linear();
    EXPECT_NEAR(rpy_of(rotation).y(), pitch, 1e-7);
    EXPECT_NEAR(rpy_of((1.0 + 1e-15) * rotation).y(), pitch, 1e-7);
  }
}

TEST(Pose, InterpolationTakesTheShortWayAround) {
  const Pose middle = interpolate(pose_with_yaw(0.0, 170.0 * kPi / 180), pose_with_yaw(2.0, -170.0 * kPi / 180), 0.5);
  EXPECT_TRUE(middle.isApprox(pose_with_yaw(1.0, kPi), 1e-12));
}

// Kills another order of the turns: only two angles at once tell.
TEST(Pose, TurnsByRollThenPitchThenYaw) {
  constexpr double kQuarter = kPi / 2;
  const Pose pose = pose_from_rpy({1.0, 2.0, 3.0}, kQuarter, kQuarter, kQuarter);
  // About the axes of the map: roll puts ahead, left, up to x, z, -y; pitch these to -z, x, -y; yaw to -z, y, x.
  EXPECT_TRUE((pose * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(1.0, 2.0, 2.0), 1e-12));
  EXPECT_TRUE((pose * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d(1.0, 3.0, 3.0), 1e-12));
  EXPECT_TRUE((pose * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(2.0, 2.0, 3.0), 1e-12));
}

TEST(Trajectory, IsReadBetweenItsPosesAndNowhereElse) {
  const auto made = Trajectory::make(
      {{10.0, pose_with_yaw(0.0, 0.0)}, {20.0, pose_with_yaw(1.0, 1.0)}, {21.0, pose_with_yaw(5.0, 1.0)}});
  ASSERT_TRUE(made);
  EXPECT_TRUE(made->at(10.0)->isApprox(pose_with_yaw(0.0, 0.0)));
  EXPECT_TRUE(made->at(12.5)->isApprox(pose_with_yaw(0.25, 0.25), 1e-12));
  EXPECT_TRUE(made->at(20.0)->isApprox(pose_with_yaw(1.0, 1.0)));
  EXPECT_TRUE(made->at(20.5)->isApprox(pose_with_yaw(3.0, 1.0), 1e-12));
  EXPECT_TRUE(made->at(21.0)->isApprox(pose_with_yaw(5.0, 1.0)));
  for (const double time_s : {9.999, 21.001, std::nan(""), -std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(made->at(time_s)) << time_s;
  }
  EXPECT_TRUE(Trajectory::still(pose_with_yaw(3.0, 1.0)).at(-1e9)->isApprox(pose_with_yaw(3.0, 1.0)));
}

TEST(Trajectory, HasNoPoseWithinAGap) {
  const auto made = Trajectory::make(
      {{10.0, pose_with_yaw(0.0, 0.0)}, {11.0, pose_with_yaw(1.0, 1.0)}, {12.5, pose_with_yaw(5.0, 1.0)}}, 1.0);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->gaps(), 1U);
  EXPECT_TRUE(made->at(10.5) && made->at(11.0) && made->at(12.5)) << "a step of just this length is none";
  EXPECT_FALSE(made->at(11.01) || made->at(12.49));
}

TEST(Trajectory, NamesThePoseThatIsOutOfOrder) {
  EXPECT_FALSE(Trajectory::make({}));
  for (const double second : {1.0, 0.5, std::nan("")}) {
    const auto made = Trajectory::make({{1.0, pose_with_yaw(0.0, 0.0)}, {second, pose_with_yaw(0.0, 0.0)}});
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, Error::Code::kCorrupt);
    EXPECT_NE(made.error().message.find("pose 1"), std::string::npos) << made.error().message;
  }
}

// Kills a path across the step of an origin that was set anew, however short it takes.
TEST(Trajectory, HasNoPoseInACut) {
  const auto made = Trajectory::make({{10.0, pose_with_yaw(0.0, 0.0)},
                                      {10.1, pose_with_yaw(0.1, 0.0)},
                                      {10.2, pose_with_yaw(40.0, 0.0)},
                                      {10.3, pose_with_yaw(40.1, 0.0)}},
                                     0.5, {2});
  ASSERT_TRUE(made);
  EXPECT_EQ(made->gaps(), 1U);
  EXPECT_TRUE(made->at(10.05));
  EXPECT_TRUE(made->at(10.1));
  EXPECT_FALSE(made->at(10.15));
  EXPECT_TRUE(made->at(10.2));
  EXPECT_TRUE(made->at(10.25));
  for (const std::vector<std::size_t>& cuts : {std::vector<std::size_t>{0}, {2}, {1, 1}}) {
    EXPECT_FALSE(Trajectory::make({{0.0, Pose::Identity()}, {1.0, Pose::Identity()}}, 0.5, cuts)) << cuts.back();
  }
}

TEST(Trajectory, StandsStillAtAllTimes) {
  const Trajectory still = Trajectory::still(pose_with_yaw(3.0, 0.0), 12.0);
  EXPECT_EQ(still.poses().front().time_s, 12.0);
  for (const double time_s : {-1e9, 0.0, 12.0, 1e10}) EXPECT_TRUE(still.at(time_s)) << time_s;
}

}  // namespace
