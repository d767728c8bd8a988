#include "nav/internal/nav_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/geometry/pose.hpp"

namespace pingvox {
namespace {

constexpr double kPi = std::numbers::pi;

NavSource framed(NavQuantity quantity, std::string frame, std::string child, const Eigen::Vector3d& value) {
  NavSource source{"/topic", quantity, {}};
  source.samples.push_back({.time_s = 0.0, .value = value});
  source.frame = std::move(frame);
  source.child = std::move(child);
  return source;
}

Pose rotation_of(const Eigen::Vector3d& rpy) {
  return pose_from_rpy(Eigen::Vector3d::Zero(), rpy.x(), rpy.y(), rpy.z());
}

TEST(NavFrames, AxesAreThoseOfTheFramesOwnName) {
  for (const char* name : {"world_ned", "base_link_frd", "ned", "NED", "bluerov2/base_link_ned", "/map_ned",
                           "ned_frame", "imu-frd", "Local_NED"}) {
    EXPECT_EQ(axes_of(name), FrameAxes::kDown) << name;
  }
  for (const char* name : {"map_enu", "base_link_flu"}) EXPECT_EQ(axes_of(name), FrameAxes::kUp) << name;
  // Kills letters within words, and the name of a vehicle.
  for (const char* name : {"", "odom", "base_link", "ned/base_link", "turned", "planned_path", "underfrd"}) {
    EXPECT_EQ(axes_of(name), FrameAxes::kNotNamed) << name;
  }
}

TEST(NavFrames, FixedFramesAndThoseOnTheVehicle) {
  for (const char* name : {"map", "odom", "world", "rov/odom", "world_ned", "ned", "camera_odom_frame", "odom_link"}) {
    EXPECT_TRUE(is_fixed_frame(name)) << name;
    EXPECT_FALSE(is_on_vehicle(name)) << name;
  }
  for (const char* name : {"base_link", "base_link_ned", "camera_optical", "map/base_link", "imu_ned", "sonar"}) {
    EXPECT_FALSE(is_fixed_frame(name)) << name;
    EXPECT_TRUE(is_on_vehicle(name)) << name;
  }
  EXPECT_FALSE(is_fixed_frame("") || is_on_vehicle("") || is_on_vehicle("Micron"));
}

// A vehicle at 1 m north, 2 m east and 5 m of depth, heading 30 degrees, bow up by 0.1 and starboard down by 0.2.
const Eigen::Vector3d kNed(1, 2, 5), kNedRpy(0.2, 0.1, kPi / 6);

TEST(NavFrames, NedBecomesOursInPoseAndMotionAlike) {
  // Kills a child without a suffix that is read as ahead, left, up in a frame that points down.
  for (const std::string child : {"base_link_ned", "base_link_frd", "base_link", ""}) {
    SCOPED_TRACE(child);
    std::vector<NavSource> sources = {framed(NavQuantity::kPosition, "world_ned", child, kNed),
                                      framed(NavQuantity::kAttitude, "world_ned", child, kNedRpy),
                                      framed(NavQuantity::kVelocity, child, "", {1, 0.5, 0.25}),
                                      framed(NavQuantity::kTurnRate, child, "", {0.1, 0.2, 0.3})};
    turn_frames(sources);
    EXPECT_TRUE(sources[0].samples[0].value.isApprox(Eigen::Vector3d(2, 1, -5)));
    EXPECT_TRUE(sources[1].samples[0].value.isApprox(Eigen::Vector3d(0.2, -0.1, kPi / 3)))
        << sources[1].samples[0].value.transpose();
    if (!child.empty()) {
      EXPECT_TRUE(sources[2].samples[0].value.isApprox(Eigen::Vector3d(1, -0.5, -0.25)));
      EXPECT_TRUE(sources[3].samples[0].value.isApprox(Eigen::Vector3d(0.1, -0.2, -0.3)));
    }
    EXPECT_NE(sources[0].note.find("world_ned"), std::string::npos) << sources[0].note;
  }
}

TEST(NavFrames, AnUprightVehicleSaysWhichOfTwoReadingsIsRight) {
  const Pose ours = rotation_of({0.2, -0.1, kPi / 3});
  Pose ned_from_ours = Pose::Identity(), frd_from_flu = Pose::Identity();
  ned_from_ours.linear() << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  frd_from_flu.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const auto turned = [](const std::string& frame, const std::string& child, const Pose& rotation) {
    std::vector<NavSource> sources = {framed(NavQuantity::kAttitude, frame, child, rpy_of(rotation.rotation()))};
    turn_frames(sources);
    return std::pair(rotation_of(sources[0].samples[0].value), sources[0].subject);
  };
  // An Imu names its own frame only.
  EXPECT_TRUE(turned("", "imu_ned", ned_from_ours * ours * frd_from_flu).first.isApprox(ours));
  EXPECT_TRUE(turned("", "imu_frd", ours * frd_from_flu).first.isApprox(ours));
  // Ahead, left, up in north, east, down, as the names say by the letter.
  EXPECT_TRUE(turned("world_ned", "base_link", ned_from_ours * ours).first.isApprox(ours));
  EXPECT_TRUE(turned("odom", "base_link_frd", ours * frd_from_flu).first.isApprox(ours));
  EXPECT_TRUE(turned("odom", "base_link", ours).first.isApprox(ours));
  EXPECT_EQ(turned("odom", "base_link_frd", ours).second, NavSubject::kOther) << "the two names contradict each other";
}

TEST(NavFrames, AVelocityInAFixedFrameIsNotTurnedAsOneOfTheBody) {
  std::vector<NavSource> sources = {framed(NavQuantity::kVelocity, "world_ned", "", {1, 2, 3})};
  sources[0].subject = NavSubject::kUncertain;
  turn_frames(sources);
  EXPECT_EQ(sources[0].samples[0].value, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace pingvox
