#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "pingvox/io/bag.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/nav/main_source.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "support/bag_writer.hpp"
#include "support/logs.hpp"
#include "support/ros_messages.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

/// The samples of a quantity in a message of ROS 2 alone in a bag.
std::vector<NavSample> samples_of(std::string_view type, std::string_view hex, NavQuantity quantity,
                                  std::string_view topic = "/topic", std::string_view definition = "") {
  bags::Mcap mcap;
  mcap.topic(1, topic, type, definition);
  mcap.message(1, 1'000'600'000'000U, from_hex(hex));
  mcap.end_chunk();
  const auto nav = read_nav(FileBytes{"dive.mcap", mcap.closed()});
  EXPECT_TRUE(nav);
  if (!nav) return {};
  EXPECT_TRUE(nav->damage.empty());
  EXPECT_EQ(nav->log.clock(), NavClock::kUnix);
  for (const NavSource& source : nav->log.sources()) {
    if (source.quantity == quantity && source.name == topic) return source.samples;
  }
  return {};
}

TEST(BagNav, ReadsWhatAnotherWriterMade) {
  const auto pressure =
      samples_of("sensor_msgs/msg/FluidPressure",
                 "00010000e80300000065cd1d0200000073000000000000002003fe400000000000000000", NavQuantity::kPressure);
  ASSERT_THAT(pressure, SizeIs(1));
  EXPECT_EQ(pressure[0].value.x(), 122'930.0);
  EXPECT_EQ(pressure[0].time_s, 1000.5);
  const auto velocity = samples_of(
      "geometry_msgs/msg/TwistStamped",
      "00010000e80300000065cd1d0400000064766c00 000000000000e03f 000000000000d0bf 0000000000000000 0000000000000000 "
      "0000000000000000 000000000000c03f",
      NavQuantity::kVelocity);
  ASSERT_THAT(velocity, SizeIs(1));
  EXPECT_EQ(velocity[0].value, Eigen::Vector3d(0.5, -0.25, 0.0)) << "already in our frame";
}

TEST(BagNav, TellsUnitsOfPressureByTheirSize) {
  const auto pascals = [](double value) {
    bags::Bytes message = {0, 1, 0, 0};
    bags::put(message, value);
    std::string hex;
    for (const std::uint8_t byte : message) hex += fmt::format("{:02x}", byte);
    const auto samples = samples_of("std_msgs/msg/Float64", hex, NavQuantity::kPressure, "/bar30/pressure");
    return samples.empty() ? 0.0 : samples[0].value.x();
  };
  EXPECT_NEAR(pascals(101.3), 101'300.0, 1e-6);
  EXPECT_NEAR(pascals(1020.0), 102'000.0, 1e-6);
  EXPECT_NEAR(pascals(150'000.0), 150'000.0, 1e-6);
}

/// The values of one quantity in messages of a topic, one after the other.
std::vector<Eigen::Vector3d> values_of(std::string_view topic, std::string_view type, std::string_view definition,
                                       const std::vector<std::vector<double>>& messages, NavQuantity quantity) {
  bags::Mcap mcap;
  mcap.topic(1, topic, type, definition);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    bags::Bytes message = {0, 1, 0, 0};
    for (const double number : messages[i]) bags::put(message, number);
    mcap.message(1, 1'000'000'000'000U + i * 1'000'000'000U, message);
  }
  mcap.end_chunk();
  const auto nav = read_nav(FileBytes{"dive.mcap", mcap.closed()});
  EXPECT_TRUE(nav);
  std::vector<Eigen::Vector3d> values;
  if (!nav) return values;
  for (const NavSource& source : nav->log.sources()) {
    if (source.quantity != quantity) continue;
    for (const NavSample& sample : source.samples) values.push_back(sample.value);
  }
  return values;
}

// A log in kPa, from the surface to 60 m: kills a unit that changes at 500 kPa, and one of a sensor that starts with 0.
TEST(BagNav, ATopicHasOneUnitOfPressure) {
  const auto values = values_of("/bar30/pressure", "std_msgs/msg/Float64", "",
                                {{0.0}, {101.3}, {499.0}, {501.0}, {700.0}}, NavQuantity::kPressure);
  ASSERT_THAT(values, SizeIs(5));
  EXPECT_NEAR(values[1].x(), 101'300.0, 1e-6);
  EXPECT_NEAR(values[2].x(), 499'000.0, 1e-6);
  EXPECT_NEAR(values[3].x(), 501'000.0, 1e-6);
  EXPECT_NEAR(values[4].x(), 700'000.0, 1e-6);
}

// 604 kPa at the beginning were read as 604 hPa, which is above the surface, and a gauge's Pa as hPa.
TEST(BagNav, ThePressuresOfFluidsAreAbsolutePascals) {
  const auto pressures = [](double first_pa, double zero_pa, double unit_pa) {
    std::vector<std::vector<double>> messages;
    for (int i = 0; i < 100; ++i) messages.push_back({(first_pa + 500.0 * i - zero_pa) / unit_pa});
    return values_of("/pressure", "lab_msgs/msg/FluidPressure", "float64 fluid_pressure\n", messages,
                     NavQuantity::kPressure);
  };
  const std::vector<std::tuple<double, double, double>> drivers = {
      {603'916.0, 0.0, 1.0}, {603'916.0, 0.0, 1e3}, {106'351.0, 101'325.0, 1.0}, {106'351.0, 0.0, 1e2}};
  for (const auto& [first_pa, zero_pa, unit_pa] : drivers) {
    const auto values = pressures(first_pa, zero_pa, unit_pa);
    ASSERT_THAT(values, SizeIs(100));
    EXPECT_NEAR(values[0].x(), first_pa, 1e-6) << unit_pa;
    EXPECT_NEAR(values[99].x(), first_pa + 49'500.0, 1e-6) << unit_pa;
  }
}

// Kills fixes that are lost, or jump to height 0, where the receiver knows no altitude.
TEST(BagNav, AFixWithoutAltitudeKeepsTheLastOne) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto values =
      values_of("/gps", "lab_msgs/msg/NavSatFix",
                "float64 latitude\nfloat64 longitude\nfloat64 altitude\n"
                "Status status\n================\nMSG: lab_msgs/Status\nfloat64 status\n",
                {{60.0, 10.0, kNone, 0.0}, {60.0, 10.0, 41.5, 0.0}, {60.0, 10.0, kNone, 0.0}}, NavQuantity::kFix);
  ASSERT_THAT(values, SizeIs(3));
  EXPECT_EQ(values[0].z(), 0.0);
  EXPECT_EQ(values[1].z(), 41.5);
  EXPECT_EQ(values[2].z(), 41.5);
}

/// A message of tf in CDR, as it grows.
class Transforms {
 public:
  explicit Transforms(std::uint32_t count) { number(count); }

  void add(std::string_view parent, std::string_view child, const std::vector<double>& place_and_rotation) {
    number(std::int32_t{1000});
    number(std::uint32_t{500'000'000});
    text(parent);
    text(child);
    for (const double each : place_and_rotation) number(each);
  }
  const bags::Bytes& bytes() const { return bytes_; }

 private:
  template <class T>
  void number(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back(0);
    bags::put(bytes_, value);
  }
  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
  }

  bags::Bytes bytes_ = {0, 1, 0, 0};
};

/// A bag with one message of tf, in which the vehicle is the last of three.
bags::Mcap bag_of_transforms(std::string_view topic) {
  Transforms transforms(3);
  transforms.add("base_link", "sonar", {0.1, 0, -0.4, 1, 0, 0, 0});
  transforms.add("map", "odom", {7, 7, 7, 0, 0, 0, 1});
  transforms.add("rov/odom", "rov/base_link", {1, 2, -3, 0, 0, std::sqrt(0.5), std::sqrt(0.5)});
  bags::Mcap mcap;
  mcap.topic(1, topic, "tf2_msgs/msg/TFMessage", "");
  mcap.message(1, 1'000'600'000'000U, transforms.bytes());
  return mcap;
}

std::vector<NavSource> sources_in(bags::Mcap mcap) {
  mcap.end_chunk();
  const auto nav = read_nav(FileBytes{"dive.mcap", mcap.closed()});
  EXPECT_TRUE(nav);
  return nav ? std::vector(nav->log.sources().begin(), nav->log.sources().end()) : std::vector<NavSource>{};
}

// Kills a reader that takes the first transform of a message only, or a sensor for the vehicle.
TEST(BagNav, TheVehicleIsWhatMovesInAFixedFrameOfTf) {
  const auto sources = sources_in(bag_of_transforms("/tf"));
  ASSERT_THAT(sources, SizeIs(2));
  for (const NavSource& source : sources) {
    EXPECT_EQ(source.name, "/tf:rov/odom:rov/base_link");
    ASSERT_THAT(source.samples, SizeIs(1));
    EXPECT_EQ(source.samples[0].time_s, 1000.5);
    if (source.quantity == NavQuantity::kPosition) {
      EXPECT_EQ(source.samples[0].value, Eigen::Vector3d(1, 2, -3));
    } else {
      EXPECT_EQ(source.quantity, NavQuantity::kAttitude);
      EXPECT_NEAR((source.samples[0].value - Eigen::Vector3d(0, 0, std::acos(0.0))).norm(), 0.0, 1e-12);
    }
  }
  EXPECT_THAT(sources_in(bag_of_transforms("/tf_static")), SizeIs(0)) << "what does not move";
}

// Kills a path of tf, which may be filtered or in another frame, instead of the one that was measured; and tf that is
// gone because of a goal that somebody clicked.
TEST(BagNav, TfIsReadBesideOtherPositions) {
  bags::Mcap mcap = bag_of_transforms("/tf");
  mcap.topic(2, "/odom", "nav_msgs/msg/Odometry", "");
  mcap.message(2, 1'000'700'000'000U, bags::odometry(1000.7, "odom", "base_link", bags::pose_numbers(0, 0, 0, 0)));
  const auto sources = sources_in(std::move(mcap));
  EXPECT_EQ(std::ranges::count(sources, "/tf:rov/odom:rov/base_link", &NavSource::name), 2);
  const auto log = NavLog::make(sources, NavClock::kUnix);
  EXPECT_EQ(path_sources(*log).position->name, "/odom");
}

constexpr double kPi = std::numbers::pi;

/// A bag with one message of tf each tenth of a second.
struct TfBag {
  bags::Mcap mcap;
  explicit TfBag(std::string_view topic = "/tf") {
    mcap.topic(1, topic, "tf2_msgs/msg/TFMessage", "");
    mcap.topic(2, "/tf_static", "tf2_msgs/msg/TFMessage", "");
  }
  void add(double time_s, const std::vector<bags::Transform>& all) {
    mcap.message(1, bags::nanoseconds(time_s), bags::transforms(time_s, all));
  }
};

/// "name: place, yaw in degrees" of the first sample of the chosen path.
std::string path_in(bags::Mcap mcap) {
  const auto log = NavLog::make(sources_in(std::move(mcap)), NavClock::kUnix);
  const auto made = nav_trajectory(*log);
  if (!made) return made.error().message;
  const Pose& pose = made->trajectory.poses().front().map_from_body;
  const Eigen::Vector3d at = pose.translation(), rpy = rpy_of(pose.rotation());
  return fmt::format("{}: {:.3f} {:.3f} {:.3f}, {:.1f}", made->position, at.x() + 0.0, at.y() + 0.0, at.z() + 0.0,
                     rpy.z() * 180.0 / kPi);
}

// Of two transforms one was used: the depth of base_link, or the frame map, was lost.
TEST(BagNav, TransformsOfTfAreJoined) {
  TfBag footprint, slam;
  for (double time_s = 1000.0; time_s < 1010.0; time_s += 0.1) {
    footprint.add(time_s, {{"odom", "base_footprint", bags::pose_numbers(time_s - 1000.0, 0, 0, 0)},
                           {"base_footprint", "base_link", bags::pose_numbers(0, 0, -5, kPi / 2)}});
    slam.add(time_s, {{"map", "odom", bags::pose_numbers(10, 0, 0, kPi / 2)}});
    slam.add(time_s + 0.03, {{"odom", "base_link", bags::pose_numbers(time_s - 999.9, 0, -5, 0)}});
  }
  EXPECT_EQ(path_in(footprint.mcap), "/tf:odom:base_link: 0.000 0.000 -5.000, 90.0");
  EXPECT_EQ(path_in(slam.mcap), "/tf:map:base_link: 10.000 0.100 -5.000, 90.0");
}

TEST(BagNav, TransformsAreInterpolatedAtTheTimesOfTheOthers) {
  TfBag bag;
  bag.mcap.message(2, bags::nanoseconds(1000),
                   bags::transforms(1000, {{"base", "base_link", bags::pose_numbers(0, 1, 0, 0)}}));
  for (int i = 0; i <= 10; ++i) {
    bag.add(1000.0 + i, {{"map", "odom", bags::pose_numbers(2.0 * i, 0, 0, 0)}});
    bag.add(1000.5 + i, {{"odom", "base", bags::pose_numbers(0, 0, -i, 0)}});
  }
  const auto sources = sources_in(bag.mcap);
  const auto joined = std::ranges::find(sources, "/tf:map:base_link", &NavSource::name);
  ASSERT_NE(joined, sources.end());
  ASSERT_EQ(joined->quantity, NavQuantity::kPosition);
  ASSERT_THAT(joined->samples, SizeIs(20)) << "at the times of both, where both are known";
  EXPECT_TRUE(joined->samples[0].value.isApprox(Eigen::Vector3d(1, 1, 0))) << "at 1000.5 s";
  EXPECT_TRUE(joined->samples[1].value.isApprox(Eigen::Vector3d(2, 1, -0.5))) << "at 1001 s";
  EXPECT_EQ(joined->note, "map -> odom -> base -> base_link");
}

TEST(BagNav, WhatTfCannotJoinIsSaid) {
  TfBag bag;
  bag.add(1000.0, {{"map", "odom", bags::pose_numbers(0, 0, 0, 0)},
                   {"base_footprint", "base_link", bags::pose_numbers(0, 0, 0, 0)}});
  bag.mcap.end_chunk();
  const auto read = read_bag(ByteStream(FileBytes{"dive.mcap", bag.mcap.closed()}));
  ASSERT_TRUE(read);
  EXPECT_THAT(read->nav.log.sources(), SizeIs(0));
  EXPECT_THAT(read->notes, ElementsAre("/tf: tf does not join base_link to map"));
}

// Kills a walk without an end, and one whose time grows with the square of what a bag says.
TEST(BagNav, TransformsOfManyFramesAndInCirclesEnd) {
  TfBag bag;
  std::vector<std::string> names;
  for (int i = 0; i < 3000; ++i) names.push_back(fmt::format("base_link_{}", i));
  for (std::size_t i = 0; i + 1 < names.size(); ++i) {
    bag.add(1000.0 + static_cast<double>(i) * 0.01, {{names[i], names[i + 1], bags::pose_numbers(1, 0, 0, 0)},
                                                     {names[i + 1], names[i], bags::pose_numbers(1, 0, 0, 0)},
                                                     {"odom", names[i], bags::pose_numbers(1, 0, 0, 0)},
                                                     {names[i], "odom", bags::pose_numbers(1, 0, 0, 0)},
                                                     {"odom", "map", bags::pose_numbers(1, 0, 0, 0)},
                                                     {"map", "odom", bags::pose_numbers(1, 0, 0, 0)}});
  }
  EXPECT_LE(sources_in(bag.mcap).size(), 64U);
}

TEST(BagNav, ASonarIsMountedAsTfSays) {
  TfBag bag;
  bag.mcap.topic(3, "/echo", "ping360_sonar_msgs/msg/SonarEcho", "");
  bag.mcap.message(2, bags::nanoseconds(1000),
                   bags::transforms(1000, {{"base_link", "frame_link", bags::pose_numbers(0.25, 0, 0.1, kPi / 2)},
                                           {"frame_link", "sonar_link", bags::pose_numbers(0.5, 0, -0.4, 0)}}));
  bag.mcap.message(3, bags::nanoseconds(1000), bags::sonar_echo(1000, "/sonar_link", 0.0F, 10));
  bag.mcap.end_chunk();
  const auto read = read_bag(ByteStream(FileBytes{"dive.mcap", bag.mcap.closed()}));
  ASSERT_TRUE(read);
  const auto sonar = std::ranges::find(read->topics, "/echo", &BagTopicSummary::name);
  ASSERT_NE(sonar, read->topics.end());
  EXPECT_EQ(sonar->frame, "sonar_link");
  ASSERT_TRUE(sonar->mount);
  EXPECT_EQ(sonar->mount->vehicle, "base_link");
  EXPECT_TRUE(sonar->mount->body_from_sensor.isApprox(pose_from_rpy({0.25, 0.5, -0.3}, 0, 0, kPi / 2), 1e-9))
      << sonar->mount->body_from_sensor.matrix();
}

/// The path of a bag in which the vehicle stands still at 5 m of depth, heading 30 degrees east of north.
std::string path_of_odometry(std::string_view frame, std::string_view child, const std::vector<double>& pose) {
  bags::Mcap mcap;
  mcap.topic(1, "/pose_gt", "nav_msgs/msg/Odometry", "");
  for (int i = 0; i < 3; ++i) {
    mcap.message(1, bags::nanoseconds(1000 + i), bags::odometry(1000 + i, frame, child, pose, {1.0, 0.5, 0.25}));
  }
  std::string velocity;
  for (const NavSource& source : sources_in(mcap)) {
    if (source.quantity != NavQuantity::kVelocity) continue;
    const Eigen::Vector3d v = source.samples.front().value;
    velocity = fmt::format("; {:.2f} {:.2f} {:.2f}", v.x(), v.y(), v.z());
  }
  return path_in(mcap) + velocity;
}

// `pose_gt` of uuv_simulator, which has a `_ned` twin, was mapped at 5 m above the water and turned.
TEST(BagNav, OdometryInNedIsTheSamePathAsInEnu) {
  const std::string ours = path_of_odometry("world", "base_link", bags::pose_numbers(3, 2, -5, kPi / 3));
  EXPECT_EQ(ours, "/pose_gt: 3.000 2.000 -5.000, 60.0; 1.00 0.50 0.25");
  const std::string turned = "/pose_gt: 3.000 2.000 -5.000, 60.0; 1.00 -0.50 -0.25";
  const auto ned = bags::pose_numbers(2, 3, 5, kPi / 6);
  EXPECT_EQ(path_of_odometry("world_ned", "base_link_ned", ned), turned);
  EXPECT_EQ(path_of_odometry("/rov/odom_ned", "/rov/base_link_frd", ned), turned);
  EXPECT_EQ(path_of_odometry("world_ned", "base_link", ned), turned) << "upright as forward, right, down";
  // By the letter: ahead, left, up in north, east, down is on its back.
  EXPECT_EQ(path_of_odometry("world_ned", "base_link", bags::pose_numbers(2, 3, 5, kPi / 6, true)), ours);
  EXPECT_EQ(path_of_odometry("odom", "base_link_frd", bags::pose_numbers(3, 2, -5, kPi / 3, true)), turned);
  EXPECT_THAT(path_of_odometry("odom", "base_link_frd", bags::pose_numbers(3, 2, -5, kPi / 3)),
              HasSubstr("no valid attitude"));
}

// At rest it is 9.8 m/s2 upward (REP-145).
TEST(BagNav, AnAccelerationThatPointsDownIsDoubtful) {
  const auto doubt_of = [](const char* frame, double upward_m_s2) {
    bags::Mcap mcap;
    mcap.topic(1, "/imu", "sensor_msgs/msg/Imu", "");
    for (int i = 0; i < 30; ++i) {
      const double time_s = 1000.0 + 0.1 * i;
      mcap.message(1, bags::nanoseconds(time_s), bags::imu(time_s, frame, {0, 0, 0, 1}, {0, 0, 0}, upward_m_s2));
    }
    std::string doubts;
    for (const NavSource& source : sources_in(mcap)) doubts += source.doubt;
    return doubts;
  };
  EXPECT_THAT(doubt_of("imu_link", -9.8), HasSubstr("its acceleration points down"));
  EXPECT_EQ(doubt_of("imu_link", 9.8), "");
  EXPECT_EQ(doubt_of("imu_link_ned", -9.8), "") << "as its name says";
}

TEST(BagNav, PosesTwistsAndImusInNedAreTurned) {
  bags::Mcap mcap;
  mcap.topic(1, "/pose", "geometry_msgs/msg/PoseStamped", "");
  mcap.topic(2, "/twist", "geometry_msgs/msg/TwistStamped", "");
  mcap.topic(3, "/imu", "sensor_msgs/msg/Imu", "");
  const std::vector<double> north_east_down = bags::pose_numbers(2, 3, 5, kPi / 6);
  const std::vector<double> rotation(north_east_down.begin() + 3, north_east_down.end());
  mcap.message(1, bags::nanoseconds(1000), bags::pose_stamped(1000, "map_ned", north_east_down));
  mcap.message(2, bags::nanoseconds(1000), bags::twist_stamped(1000, "base_link_frd", {1, 2, 3, 0.1, 0.2, 0.3}));
  mcap.message(3, bags::nanoseconds(1000), bags::imu(1000, "imu_link_ned", rotation, {0.1, 0.2, 0.3}));
  std::size_t compared = 0;
  for (const NavSource& source : sources_in(mcap)) {
    SCOPED_TRACE(source.name);
    Eigen::Vector3d right(3, 2, -5);
    if (source.quantity == NavQuantity::kAttitude) right = {0, 0, kPi / 3};
    if (source.quantity == NavQuantity::kVelocity) right = {1, -2, -3};
    if (source.quantity == NavQuantity::kTurnRate) right = {0.1, -0.2, -0.3};
    EXPECT_LT((source.samples.front().value - right).norm(), 1e-9) << source.samples.front().value.transpose();
    ++compared;
  }
  EXPECT_EQ(compared, 6U);
}

// A hint at navigation in a bag read all of it once more.
TEST(BagNav, TheBeginningOfABagCanBeReadAlone) {
  bags::Mcap mcap;
  mcap.topic(1, "/pose", "geometry_msgs/msg/PoseStamped", "");
  const bags::Bytes pose = bags::pose_stamped(1000, "map", bags::pose_numbers(0, 0, 0, 0));
  for (int i = 0; i < 100; ++i) mcap.message(1, bags::nanoseconds(1000 + i), pose);
  mcap.end_chunk();
  const FileBytes file{"dive.mcap", mcap.closed()};
  EXPECT_EQ(read_bag(ByteStream(file))->topics[0].messages, 100U);
  EXPECT_EQ(read_bag(ByteStream(file), Damage::kSkip, {}, 10 * pose.size())->topics[0].messages, 10U);
}

// Kills a path that jumps between two publishers of one topic.
TEST(BagNav, MessagesOfOneTopicInTwoFramesAreTwoSources) {
  bags::Mcap mcap;
  mcap.topic(1, "/pose", "geometry_msgs/msg/PoseStamped", "");
  for (int i = 0; i < 6; ++i) {
    const std::string_view frame = i % 2 == 0 ? "map" : "odom";
    mcap.message(1, bags::nanoseconds(1000 + i), bags::pose_stamped(1000 + i, frame, bags::pose_numbers(i, 0, 0, 0)));
  }
  const auto sources = sources_in(mcap);
  ASSERT_THAT(sources, SizeIs(4));
  EXPECT_EQ(sources[0].name, "/pose");
  EXPECT_THAT(sources[0].samples, SizeIs(3));
  EXPECT_EQ(std::ranges::count(sources, "/pose:odom:", &NavSource::name), 2);
}

// Kills thousands of sources, each compared with all others.
TEST(BagNav, ATopicHasAFewFramesAndTheRestIsDamage) {
  bags::Mcap mcap;
  mcap.topic(1, "/pose", "geometry_msgs/msg/PoseStamped", "");
  for (int i = 0; i < 100; ++i) {
    const std::string frame = fmt::format("map_{}", i);
    mcap.message(1, bags::nanoseconds(1000 + i), bags::pose_stamped(1000 + i, frame, bags::pose_numbers(i, 0, 0, 0)));
  }
  mcap.end_chunk();
  const auto nav = read_nav(FileBytes{"dive.mcap", mcap.closed()});
  ASSERT_TRUE(nav);
  EXPECT_THAT(nav->log.sources(), SizeIs(32));
  ASSERT_THAT(nav->damage, SizeIs(1));
  EXPECT_EQ(nav->damage[0].count, 84U);
}

TEST(BagNav, TurnsADvlThatLooksDown) {
  constexpr std::string_view kDefinition =
      "geometry_msgs/Vector3 velocity\nfloat64 fom\nfloat64 altitude\nbool velocity_valid\n";
  const std::string hex =
      "00010000 000000000000f03f 0000000000000040 0000000000000840 0000000000000000 0000000000001040 01";
  const auto down = samples_of("waterlinked_a50_ros_driver/msg/DVL", hex, NavQuantity::kVelocity, "/dvl", kDefinition);
  ASSERT_THAT(down, SizeIs(1));
  EXPECT_EQ(down[0].value, Eigen::Vector3d(1, -2, -3));
  const auto ahead = samples_of("sensors/msg/DVLVelocity", hex, NavQuantity::kVelocity, "/dvl", kDefinition);
  ASSERT_THAT(ahead, SizeIs(1));
  EXPECT_EQ(ahead[0].value, Eigen::Vector3d(3, 1, 2)) << "of SOLAQUA: x left, y up, z ahead";
}

/// Odometry of 40 s, two messages a second, with these stamps, and echoes of a sonar with others.
BagContents dive_with_stamps(double (*stamp_s)(double), double (*echo_s)(double), double first_s = 1000.0) {
  bags::Mcap mcap;
  mcap.topic(1, "/odom", "nav_msgs/msg/Odometry", "");
  mcap.topic(2, "/echo", "ping360_sonar_msgs/msg/SonarEcho", "");
  for (int i = 0; i < 80; ++i) {
    const double time_s = first_s + 0.5 * i;
    mcap.message(1, bags::nanoseconds(time_s),
                 bags::odometry(stamp_s(time_s), "odom", "base_link", bags::pose_numbers(0.1 * i, 0.0, -5.0, 0.0)));
    mcap.message(2, bags::nanoseconds(time_s), bags::sonar_echo(echo_s(time_s), "sonar", 0.0F, 10));
  }
  mcap.end_chunk();
  auto contents = read_bag(ByteStream(FileBytes{"dive.mcap", mcap.closed()}));
  EXPECT_TRUE(contents);
  return *std::move(contents);
}

// Kills a path of which all is at one moment.
TEST(BagNav, StampsThatStandStillAreNone) {
  const auto now = [](double time_s) { return time_s; };
  const BagContents contents = dive_with_stamps([](double) { return 1005.0; }, now);
  for (const NavSource& source : contents.nav.log.sources()) {
    ASSERT_THAT(source.samples, SizeIs(80));
    EXPECT_EQ(source.samples[41].time_s, 1020.5);
    EXPECT_THAT(source.note, HasSubstr("the stamps of /odom do not change"));
  }
  EXPECT_THAT(dive_with_stamps(now, now).nav.notes, SizeIs(0));
}

// Kills beams that are mapped where the vehicle was eight seconds before, without a word.
TEST(BagNav, StampsOfOneTopicThatLagAreNamed) {
  const auto now = [](double time_s) { return time_s; };
  const auto late = [](double time_s) { return time_s - 8.0; };
  EXPECT_THAT(dive_with_stamps(now, late).nav.notes,
              ElementsAre(HasSubstr("messages of /echo are recorded 8.0 s after their stamps, those of /odom 0.0 s")));
  EXPECT_THAT(dive_with_stamps(late, now).nav.notes, SizeIs(1));
  EXPECT_THAT(dive_with_stamps(late, late).nav.notes, SizeIs(0)) << "one clock";
}

// Kills a vehicle that does all of its dive at once, where the recorder's times are none.
TEST(BagNav, StampsWithDatesAreTakenWhereTheRecordingHasNone) {
  const auto date = [](double time_s) { return 1.6e9 + time_s; };
  const BagContents contents = dive_with_stamps(date, date);
  EXPECT_THAT(contents.nav.notes, SizeIs(0));
  for (const NavSource& source : contents.nav.log.sources()) {
    ASSERT_THAT(source.samples, SizeIs(80));
    EXPECT_NEAR(source.samples[41].time_s, 1.6e9 + 1020.5, 1e-6);
  }
}

// Kills a bag that was played five times as fast, and recorded again, without a word.
TEST(BagNav, StampsThatGoFasterThanTheRecordingAreNamed) {
  const auto faster = [](double time_s) { return 1.6e9 + 5.0 * (time_s - 1.7e9); };
  const auto as_fast = [](double time_s) { return time_s - 1e8; };
  EXPECT_THAT(dive_with_stamps(faster, faster, 1.7e9).nav.notes,
              ElementsAre(HasSubstr("the stamps of /odom go 5 times as fast as the recording")));
  EXPECT_THAT(dive_with_stamps(as_fast, as_fast, 1.7e9).nav.notes, SizeIs(0)) << "played again as it was";
}

// Kills a pressure that is read as one of several units.
TEST(BagNav, APressureOfSeveralPossibleUnitsIsNotUsed) {
  bags::Mcap mcap;
  mcap.topic(1, "/ctd/pressure", "std_msgs/msg/Float64", "");
  for (int i = 0; i < 100; ++i) {
    bags::Bytes message = {0, 1, 0, 0};
    bags::put(message, 20.0 + 0.01 * i);  // dbar
    mcap.message(1, 1'000'000'000'000U + static_cast<std::uint64_t>(i) * 1'000'000'000U, message);
  }
  mcap.end_chunk();
  const auto nav = read_nav(FileBytes{"dive.mcap", mcap.closed()});
  ASSERT_TRUE(nav);
  ASSERT_THAT(nav->log.sources(), SizeIs(1));
  EXPECT_THAT(nav->log.sources()[0].fault, HasSubstr("dbar above that of air ("));
}

}  // namespace
}  // namespace pingvox
