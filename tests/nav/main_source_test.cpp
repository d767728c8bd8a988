#include "pingvox/nav/main_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox {
namespace {

using testing::HasSubstr;

/// Samples at 10 Hz of a vehicle that turns and goes north.
NavSource sampled(std::string name, NavQuantity quantity, double from_s, double to_s, double step_s = 0.1) {
  NavSource source{std::move(name), quantity, {}};
  const long count = std::lround((to_s - from_s) / step_s);
  for (long i = 0; i <= count; ++i) {
    const double time_s = from_s + step_s * static_cast<double>(i);
    const double yaw_rad = std::remainder(0.1 * time_s, 2.0 * std::numbers::pi);
    const double radius_m = quantity == NavQuantity::kFix ? 6.4e6 : 1.0;
    source.samples.push_back({.time_s = time_s,
                              .value = quantity == NavQuantity::kAttitude
                                           ? Eigen::Vector3d(0.01, 0.0, yaw_rad)
                                           : Eigen::Vector3d(0.0, 0.2 * time_s / radius_m, -5.0)});
  }
  return source;
}

NavSource uncertain(NavSource source, std::string frame) {
  source.subject = NavSubject::kUncertain;
  source.frame = std::move(frame);
  return source;
}

NavSource of_tf(NavSource source, std::string frame) {
  source = uncertain(std::move(source), std::move(frame));
  source.subject = NavSubject::kTransforms;
  return source;
}

/// "position and attitude", in any order of the sources.
std::string path_of(std::vector<NavSource> sources) {
  std::vector<std::string> found;
  std::ranges::sort(sources, std::greater(), &NavSource::name);
  for (int i = 0; i < 2; ++i) {
    const auto log = NavLog::make(sources, NavClock::kUnix);
    if (!log) return log.error().message;
    const PathSources path = path_sources(*log);
    found.push_back((path.position != nullptr ? path.position->name : "none") + " and " +
                    (path.attitude != nullptr ? path.attitude->name : "none"));
    std::ranges::reverse(sources);
  }
  return found[0] == found[1] ? found[0] : found[0] + ", but reversed " + found[1];
}

constexpr auto kPosition = NavQuantity::kPosition, kAttitude = NavQuantity::kAttitude, kFix = NavQuantity::kFix;

// Kills its use as a pose of the vehicle, which then stood where its odometry began.
TEST(MainSource, AnInvertedPoseIsNotTaken) {
  NavSource inverted = sampled("/inverted", kPosition, 0, 100);
  inverted.frame = "base_link";
  inverted.child = "odom";
  EXPECT_EQ(path_of({inverted, sampled("ATTITUDE", kAttitude, 0, 100)}), "none and ATTITUDE");
  std::swap(inverted.frame, inverted.child);
  EXPECT_EQ(path_of({inverted, sampled("ATTITUDE", kAttitude, 0, 100)}), "/inverted and ATTITUDE");
}

// Kills the last main estimate of the log, whatever it covers: the order of the files decided.
TEST(MainSource, OfTwoLogsTheAttitudeThatGoesWithThePosition) {
  EXPECT_EQ(path_of({sampled("LOCAL_POSITION_NED", kPosition, 0, 100), sampled("ATTITUDE", kAttitude, 0, 100),
                     sampled("ATT", kAttitude, 500, 900)}),
            "LOCAL_POSITION_NED and ATTITUDE");
  EXPECT_EQ(path_of({sampled("LOCAL_POSITION_NED", kPosition, 0, 100), sampled("ATTITUDE", kAttitude, 99, 102),
                     sampled("ATT", kAttitude, 0, 99)}),
            "LOCAL_POSITION_NED and ATT");
}

TEST(MainSource, APositionCoversTheLog) {
  EXPECT_EQ(path_of({sampled("ATTITUDE", kAttitude, 0, 100), sampled("fast", kPosition, 0, 5, 0.001),
                     sampled("whole", kPosition, 0, 100)}),
            "whole and ATTITUDE");
  EXPECT_EQ(path_of({sampled("ATTITUDE", kAttitude, 0, 10), sampled("near", kPosition, 0, 10),
                     sampled("long, never turned", kPosition, 1000, 9000, 1.0)}),
            "near and ATTITUDE");
}

TEST(MainSource, OdometryBeforePosesOfUnknownThings) {
  const NavSource turns = sampled("imu", kAttitude, 0, 30);
  const NavSource odometry = sampled("/odom", kPosition, 0, 30);
  EXPECT_EQ(path_of({turns, odometry, uncertain(sampled("/slam/pose", kPosition, 0, 30, 0.01), "map")}),
            "/odom and imu");
  EXPECT_EQ(path_of({turns, odometry, of_tf(sampled("/tf", kPosition, 0, 30, 0.01), "map")}), "/odom and imu");
  EXPECT_EQ(path_of({turns, uncertain(sampled("/slam/pose", kPosition, 0, 30), "map"),
                     uncertain(sampled("/some/pose", kPosition, 0, 30, 0.01), "lab"), sampled("gps", kFix, 0, 30)}),
            "/slam/pose and imu");
  EXPECT_EQ(path_of({turns, of_tf(sampled("/tf:odom:base_link", kPosition, 0, 30), "odom"),
                     uncertain(sampled("/lab/pose", kPosition, 0, 30, 0.01), "map")}),
            "/tf:odom:base_link and imu")
      << "tf was dropped where another topic had a pose";
  EXPECT_EQ(path_of({turns, uncertain(sampled("/lab/pose", kPosition, 0, 30), "map"), sampled("cut", kPosition, 0, 3)}),
            "/lab/pose and imu")
      << "odometry that ends early";
}

// An AHRS draws its attitude by tf, at 0, 0, 0.
TEST(MainSource, AnAttitudeOfTfIsNotThePlace) {
  NavSource still = of_tf(sampled("/tf:world:imu", kPosition, 0, 30), "world");
  for (NavSample& sample : still.samples) sample.value.setZero();
  EXPECT_EQ(path_of({of_tf(sampled("/tf:world:imu", kAttitude, 0, 30), "world"), still, sampled("gps", kFix, 0, 30)}),
            "gps and /tf:world:imu");
}

TEST(MainSource, GoalsMarkersAndPosesOnTheVehicleAreNoPath) {
  const NavSource turns = sampled("imu", kAttitude, 0, 30);
  for (const char* topic : {"/goal_pose", "/move_base_simple/goal", "/initialpose", "/mavros/setpoint_position/local",
                            "/aruco/pose", "/tag_3"}) {
    EXPECT_EQ(path_of({turns, uncertain(sampled(topic, kPosition, 0, 30), "map")}), "none and imu") << topic;
  }
  for (const char* frame : {"camera_optical", "base_link", "rov/camera_link"}) {
    EXPECT_EQ(path_of({turns, uncertain(sampled("/pose", kPosition, 0, 30), frame)}), "none and imu") << frame;
  }
  for (const char* frame : {"", "map", "rov/odom", "Micron"}) {
    EXPECT_EQ(path_of({turns, uncertain(sampled("/pose", kPosition, 0, 30), frame)}), "/pose and imu") << frame;
  }
}

/// Whether a source of this name and frame is the vehicle's, beside nothing else.
bool is_taken(const char* name, NavQuantity quantity, const char* child = "") {
  NavSource source = sampled(name, quantity, 0, 30);
  source.child = child;
  const auto log = NavLog::make({source}, NavClock::kUnix);
  return log->best(quantity) != nullptr;
}

// Commands came more often than what they ask for, and were taken.
TEST(MainSource, CommandsAndPlansAreNotTheVehicle) {
  constexpr auto kDepth = NavQuantity::kDepth, kVelocity = NavQuantity::kVelocity;
  for (const char* word : {"desired", "cmd", "target", "setpoint", "goal", "ref", "plan", "reference", "max"}) {
    for (const NavQuantity quantity : {kDepth, kVelocity, kPosition, kAttitude, kFix}) {
      const std::string name = std::string("/") + word + "_thing";
      EXPECT_FALSE(is_taken(name.c_str(), quantity)) << name;
    }
  }
  EXPECT_FALSE(is_taken("/cmd_vel", kVelocity));
  EXPECT_FALSE(is_taken("/rov/desiredDepth2", kDepth));
  EXPECT_FALSE(is_taken("/tf:map:base_link_cmd", kPosition, "base_link_cmd"));
  for (const char* name : {"/bar30/depth", "/dvl/twist", "/refinement/odom", "/commander/pose", "ATTITUDE"}) {
    EXPECT_TRUE(is_taken(name, kDepth)) << name;
  }
}

TEST(MainSource, OtherThingsAreNotTheVehicle) {
  for (const char* name : {"/ship/fix", "/base/fix", "/home/fix", "/buoy1/fix"}) EXPECT_FALSE(is_taken(name, kFix));
  for (const char* name : {"/rov/usbl/fix", "/gps", "GPS_RAW_INT"}) EXPECT_TRUE(is_taken(name, kFix)) << name;
  EXPECT_TRUE(is_taken("/base/odom", kPosition)) << "a mobile base";
  EXPECT_FALSE(is_taken("/dock/pose", kPosition));
  EXPECT_FALSE(is_taken("/wind/twist", NavQuantity::kVelocity));
  EXPECT_FALSE(is_taken("/water_depth", NavQuantity::kDepth));
  EXPECT_FALSE(is_taken("/echosounder/seafloor_depth", NavQuantity::kDepth));
  EXPECT_FALSE(is_taken("/internal_pressure", NavQuantity::kPressure));
  EXPECT_TRUE(is_taken("/water/pressure", NavQuantity::kPressure));
}

// The attitude of a gimbal turned the map by 90 degrees.
TEST(MainSource, TheAttitudeOfACameraIsNotTheVehicles) {
  EXPECT_FALSE(is_taken("/camera/imu", kAttitude, "camera_imu_optical_frame"));
  EXPECT_FALSE(is_taken("/imu", kAttitude, "gimbal_link"));
  EXPECT_FALSE(is_taken("/imu", kAttitude, "sonar_link"));
  EXPECT_TRUE(is_taken("/imu", kAttitude, "imu_link"));
  EXPECT_EQ(path_of({sampled("/camera/odom", kPosition, 0, 30), sampled("/camera/odom", kAttitude, 0, 30)}),
            "/camera/odom and /camera/odom")
      << "odometry by a camera";
}

// The driver of a Micron sends where the head looks as a pose at 0, 0, 0: all beams lay in one direction.
TEST(MainSource, TheHeadingOfAHeadIsNotTheVehicles) {
  NavSource place = uncertain(sampled("/micron/heading", kPosition, 0, 30), "map");
  NavSource head = uncertain(sampled("/micron/heading", kAttitude, 0, 30), "map");
  for (NavSample& sample : place.samples) sample.value.setZero();
  for (NavSample& sample : head.samples) sample.value.head<2>().setZero();
  EXPECT_EQ(path_of({place, head}), "none and none");
  EXPECT_EQ(path_of({place, head, sampled("/odom", kPosition, 0, 30), sampled("/odom", kAttitude, 0, 30)}),
            "/odom and /odom");
  NavSource level = head;
  for (NavSample& sample : level.samples) sample.value.z() = 1.0;
  EXPECT_EQ(path_of({place, level}), "/micron/heading and /micron/heading") << "a vehicle that stands still";
}

TEST(MainSource, AVelocityInAFixedFrameIsNotTheBodys) {
  const auto best = [](const char* frame) {
    const auto log = NavLog::make({uncertain(sampled("/v", NavQuantity::kVelocity, 0, 30), frame)}, NavClock::kUnix);
    return log->best(NavQuantity::kVelocity) != nullptr;
  };
  EXPECT_FALSE(best("odom"));
  EXPECT_TRUE(best("base_link"));
  EXPECT_TRUE(best("dvl_ned"));
}

// Kills the first of equals, which is another one when the files change places.
TEST(MainSource, TheOrderOfSourcesDoesNotMatter) {
  const std::vector<NavSource> sources = {sampled("b", NavQuantity::kDepth, 0, 30),
                                          sampled("a", NavQuantity::kDepth, 0, 30)};
  const auto one = NavLog::make(sources, NavClock::kUnix),
             other = NavLog::make({sources[1], sources[0]}, NavClock::kUnix);
  EXPECT_EQ(one->best(NavQuantity::kDepth)->name, "a");
  EXPECT_EQ(other->best(NavQuantity::kDepth)->name, "a");
}

// The journey to the place of the dive was longer than the dive.
TEST(MainSource, SourcesCoverTheTimeOfTheSonar) {
  const auto log = NavLog::make({sampled("journey", kPosition, 0, 1000), sampled("dive", kPosition, 1000, 1060),
                                 sampled("imu", kAttitude, 0, 1060), sampled("gone", kAttitude, 0, 1010)},
                                NavClock::kUnix);
  ASSERT_TRUE(log);
  EXPECT_EQ(path_sources(*log).position->name, "journey");
  const auto during = sources_between(*log, 1000.5, 1060);
  ASSERT_TRUE(during);
  EXPECT_EQ(path_sources(*during).position->name, "dive");
  EXPECT_EQ(path_sources(*during).attitude->name, "imu");
  const auto never = sources_between(*log, 2000, 2060);
  EXPECT_EQ(path_sources(*never).position->name, "journey") << "none is known then: the clocks may be wrong";
}

// Kills a depth in another unit that is left out without a word, as the pressure tells the same.
TEST(MainSource, AFaultIsSaidWhateverElseCoversTheLog) {
  NavSource depth = sampled("depth", NavQuantity::kDepth, 0, 30);
  depth.fault = "is it in cm?";
  const auto log = NavLog::make({depth, sampled("bar", NavQuantity::kPressure, 0, 30)}, NavClock::kUnix);
  ASSERT_TRUE(log);
  const auto during = sources_between(*log, 0, 30);
  ASSERT_TRUE(during);
  EXPECT_EQ(faults_text(*during), "the depth of depth cannot be used: is it in cm?");
}

TEST(MainSource, OneOfANameIsTakenInsteadOfAllOthers) {
  const auto log =
      NavLog::make({sampled("/odom", kPosition, 0, 30), sampled("/odom", kAttitude, 0, 30), sampled("gps", kFix, 0, 30),
                    sampled("imu", kAttitude, 0, 30), uncertain(sampled("/goal_pose", kPosition, 0, 30), "map")},
                   NavClock::kUnix);
  ASSERT_TRUE(log);
  const auto path = [&](std::vector<NamedSource> named) {
    const auto chosen = choose_sources(*log, named);
    if (!chosen) return chosen.error().message;
    const auto made = nav_trajectory(*chosen);
    return made ? made->position + " and " + made->attitude : made.error().message;
  };
  EXPECT_EQ(path({}), "/odom and /odom");
  EXPECT_EQ(path({{"gps"}}), "gps and /odom");
  EXPECT_EQ(path({{"gps"}, {"imu"}}), "gps and imu");
  EXPECT_EQ(path({{"/odom", kPosition}, {"imu", kAttitude}}), "/odom and imu");
  EXPECT_EQ(path({{"/goal_pose"}}), "/goal_pose and /odom") << "also one that is none by itself";
  const auto chosen = choose_sources(*log, std::vector<NamedSource>{{"/goal_pose"}});
  const auto again = NavLog::make(chosen->sources(), NavClock::kUnix);
  EXPECT_EQ(path_sources(*again).position->name, "/goal_pose") << "the choice stays";
  const std::string refused = path({{"/odo"}});
  EXPECT_THAT(refused, HasSubstr("there is no source '/odo', but /goal_pose (position), /odom (position, attitude)"));
  EXPECT_THAT(path({{"imu", kPosition}}), HasSubstr("'imu' of position"));
}

}  // namespace
}  // namespace pingvox
