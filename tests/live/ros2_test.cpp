#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "device/internal/ros2_node.hpp"
#include "io/internal/ros2_messages.hpp"
#include "live/dive.hpp"
#include "live/ros2_publisher.hpp"
#include "live/ros2_topics.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/live/live_mapping.hpp"

// Nodes and topics of ROS 2, what a run publishes, and what of its options is refused.
namespace pingvox::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// As DDS carries it.
std::string filled_up(std::string message) {
  message.resize((message.size() + 3) / 4 * 4, '\0');
  return message;
}

OccupancyMap two_cells() {
  OccupancyMap map({.resolution_m = 0.5});
  Editor editor = map.edit();
  editor.set(WideKey{5, 7, 9}, 16, LogOdds(1.0F));
  editor.set(WideKey{200, 7, 9}, 16, LogOdds(1.0F));
  return map;
}

/// What is behind the header of the map's file.
std::string tree_of(const OccupancyMap& map, Format format) {
  constexpr std::string_view kEnd = "\ndata\n";
  std::ostringstream file;
  EXPECT_TRUE(write_map(map, format, {}, file));
  const std::string text = std::move(file).str();
  return text.substr(text.find(kEnd) + kEnd.size());
}

std::string_view type_of(std::string_view topic) {
  for (const Ros2MapTopic& one : kRos2MapTopics) {
    if (one.name == topic) return one.type;
  }
  return {};
}

TEST(Ros2Names, AreThoseOfDds) {
  EXPECT_EQ(dds_topic("/octomap_binary"), "rt/octomap_binary");
  EXPECT_EQ(dds_topic("ros_discovery_info"), "ros_discovery_info");
  EXPECT_EQ(dds_type("octomap_msgs/msg/Octomap"), "octomap_msgs::msg::dds_::Octomap_");
  EXPECT_EQ(ros_type("octomap_msgs::msg::dds_::Octomap_"), "octomap_msgs/msg/Octomap");
  EXPECT_EQ(ros_type("DDS::Other"), std::nullopt);
}

TEST(Ros2Network, NamesWhatIsBroken) {
  const Ros2Network broken{.domain = 102, .interface = "<eth0>"};
  EXPECT_THAT(broken.validate().error().message, HasSubstr("domain must be in 0..101, is 102"));
  EXPECT_THAT(broken.validate().error().message, HasSubstr("interface"));
  EXPECT_TRUE(loopback().validate());
}

TEST(Ros2Publish, TakesNamesOfRos) {
  EXPECT_EQ(Ros2Publish{}.topic("/octomap_binary"), "/octomap_binary");
  EXPECT_EQ((Ros2Publish{.prefix = "rov/pingvox"}.topic("/octomap_binary")), "/rov/pingvox/octomap_binary");
  EXPECT_TRUE(Ros2Publish{.prefix = "rov/pingvox"}.validate());
  for (const std::string prefix : {"/rov", "rov/", "1rov", "a//b", "a-b", "\xc3\xa4"}) {
    EXPECT_FALSE((Ros2Publish{.prefix = prefix}.validate())) << prefix;
  }
}

TEST(Ros2Messages, AnOdometryIsThatOfOtherWriters) {
  const std::string message = ros2_odometry(1'000'500'000'000, "odom", "base_link", Pose::Identity(), {});
  EXPECT_EQ(message.size(), 724U);
  const std::string_view stamp("\0\1\0\0\xe8\3\0\0\0\x65\xcd\x1d\5\0\0\0odom\0", 21);
  EXPECT_THAT(message, StartsWith(std::string(stamp)));
}

TEST_F(Ros2, BytesArriveAsTheyWereWritten) {
  const std::string message("\0\1\0\0\5\0\0\0abcd\0", 13);
  const Ros2Topic topic{"/words", "std_msgs/msg/String"};
  const Result<Ros2Writer> writer = node().write(topic, Ros2Delivery::kKeepsLast);
  ASSERT_TRUE(writer);
  EXPECT_TRUE(writer->write("earlier"));
  EXPECT_TRUE(writer->write(message));
  // Who comes later gets the last one.
  const Ros2Reader late = reader_of(topic.name, topic.type, Ros2Delivery::kKeepsLast);
  EXPECT_EQ(late.take(kPatience_s), filled_up(message));
  EXPECT_EQ(late.take(0.0), std::nullopt);
  EXPECT_EQ(node().type_of("/words"), "std_msgs/msg/String");
  EXPECT_EQ(node().type_of("/other"), std::nullopt);
}

TEST_F(Ros2, WhatFillsAMessageUpIsLeftOutWhereItIsTold) {
  const Ros2Topic topic{"/words", "std_msgs/msg/String"};
  const Result<Ros2Writer> writer = node().write(topic, Ros2Delivery::kKeepsLast);
  ASSERT_TRUE(writer);
  EXPECT_TRUE(writer->write(std::string("\0\1\0\3\5\0\0\0abcd\0\0\0\0", 16)));
  const Ros2Reader reader = reader_of(topic.name, topic.type, Ros2Delivery::kKeepsLast);
  EXPECT_EQ(reader.take(kPatience_s), std::string("\0\1\0\3\5\0\0\0abcd\0", 13));
}

TEST_F(Ros2, OtherNodesAreToldWhatThisOneWritesAndReads) {
  constexpr std::size_t kHeader = 4, kPrefix = 12, kGid = 16, kGidOfHumble = 24, kRest = 36;
  const Ros2Topic topic{"/words", "std_msgs/msg/String"};
  for (const auto& [distribution, gid] :
       {std::pair(Ros2Distribution::kIron, kGid), std::pair(Ros2Distribution::kHumble, kGidOfHumble)}) {
    const Ros2Reader graph =
        reader_of("ros_discovery_info", "rmw_dds_common/msg/ParticipantEntitiesInfo", Ros2Delivery::kKeepsLast);
    Ros2Network network = loopback();
    network.distribution = distribution;
    const Result<Ros2Node> told = Ros2Node::open(network);
    ASSERT_TRUE(told) << told.error().message;
    const std::optional<std::string> alone = graph.take(kPatience_s);
    ASSERT_TRUE(alone);
    EXPECT_EQ(alone->size(), kRest + gid);
    EXPECT_THAT(*alone, HasSubstr(std::string("\x8\0\0\0pingvox\0", 12)));
    EXPECT_TRUE(told->write(topic, Ros2Delivery::kStream));
    const std::optional<std::string> writes = graph.take(kPatience_s);
    ASSERT_TRUE(writes);
    ASSERT_EQ(writes->size(), kRest + 2 * gid);
    EXPECT_EQ(writes->substr(writes->size() - gid, kPrefix), alone->substr(kHeader, kPrefix));
    EXPECT_TRUE(told->read(topic, Ros2Delivery::kStream));
    const std::optional<std::string> reads = graph.take(kPatience_s);
    ASSERT_TRUE(reads);
    EXPECT_EQ(reads->size(), kRest + 3 * gid);
    EXPECT_EQ(reads->substr(reads->size() - gid), writes->substr(writes->size() - gid));
  }
}

TEST_F(Ros2, ThePublishedMapIsThatOfItsFile) {
  const OccupancyMap map = two_cells();
  Result<Ros2Publisher> publisher = Ros2Publisher::open(node(), {.prefix = "rov"}, PublishTf::kYes);
  ASSERT_TRUE(publisher);
  EXPECT_TRUE(publisher->is_map_due(0.0));
  publisher->publish_map(map, 0.0, 1000.5);
  publisher->finish();
  EXPECT_EQ(publisher->problem(), "");
  EXPECT_FALSE(publisher->is_map_due(1.0));
  EXPECT_TRUE(publisher->is_map_due(1000.0));
  const Result<std::vector<Ros2Message>> expected = ros2_map_messages(map, 1'000'500'000'000, "map");
  ASSERT_TRUE(expected);
  for (const Ros2Message& message : *expected) {
    const Ros2Reader reader =
        reader_of("/rov" + std::string(message.topic), std::string(message.type), Ros2Delivery::kKeepsLast);
    EXPECT_EQ(reader.take(kPatience_s), filled_up(message.bytes)) << message.topic;
  }
  EXPECT_THAT((*expected)[2].bytes, HasSubstr(tree_of(map, Format::kBt)));
  EXPECT_THAT((*expected)[3].bytes, HasSubstr(tree_of(map, Format::kOt)));
}

TEST_F(Ros2, AMapWithoutOccupiedCellsIsNotPublished) {
  Result<Ros2Publisher> publisher = Ros2Publisher::open(node(), {}, PublishTf::kYes);
  ASSERT_TRUE(publisher);
  publisher->publish_map(OccupancyMap(), 0.0, 1000.5);
  publisher->finish();
  EXPECT_EQ(publisher->problem(), "");
  const Ros2Reader reader =
      reader_of("/octomap_binary", std::string(type_of("/octomap_binary")), Ros2Delivery::kKeepsLast);
  EXPECT_EQ(reader.take(0.0), std::nullopt);
}

double number_at(std::string_view message, std::size_t at) {
  double number = 0.0;
  std::memcpy(&number, message.substr(at).data(), sizeof(number));
  return number;
}

TEST_F(Ros2, PosesArePublishedWithTheirVelocity) {
  Result<Ros2Publisher> publisher = Ros2Publisher::open(node(), {}, PublishTf::kYes);
  ASSERT_TRUE(publisher);
  const Ros2Reader odometry = reader_of("/odometry", "nav_msgs/msg/Odometry", Ros2Delivery::kStream);
  const Ros2Reader tf = reader_of("/tf", "tf2_msgs/msg/TFMessage", Ros2Delivery::kStream);
  // Heads north, and goes there: ahead.
  const Pose first = pose_from_rpy({1.0, 2.0, -3.0}, 0.0, 0.0, std::numbers::pi / 2.0);
  Pose second = first;
  second.translation().y() += 0.1;
  publisher->publish_pose({10.0, first}, 1000.0);
  publisher->publish_pose({10.04, second}, 1000.04);  // too soon
  publisher->publish_pose({10.1, second}, 1000.1);
  publisher->finish();
  const std::optional<std::string> sent = odometry.take(kPatience_s);
  ASSERT_TRUE(sent);
  EXPECT_EQ(*sent, ros2_odometry(1'000'000'000'000, "map", "base_link", first, {}));
  const std::optional<std::string> next = odometry.take(kPatience_s);
  ASSERT_TRUE(next);
  ASSERT_EQ(next->size(), sent->size());
  const std::size_t twist_at = sent->size() - (36 + 6) * 8;
  EXPECT_NEAR(number_at(*next, twist_at), 1.0, 1e-6);
  EXPECT_NEAR(number_at(*next, twist_at + 8), 0.0, 1e-6);
  EXPECT_EQ(odometry.take(0.0), std::nullopt);
  EXPECT_EQ(tf.take(kPatience_s), filled_up(ros2_transform(1'000'000'000'000, "map", "base_link", first)));
}

TEST_F(Ros2, ARunPublishesItsMapAtTheEnd) {
  Dive dive({.ros2 = loopback(), .publish = Ros2Publish{}});
  dive.run_until_beams(50);
  ASSERT_TRUE(dive.live().finish());
  const Ros2Reader reader =
      reader_of("/octomap_binary", std::string(type_of("/octomap_binary")), Ros2Delivery::kKeepsLast);
  const std::optional<std::string> sent = reader.take(kPatience_s);
  ASSERT_TRUE(sent);
  EXPECT_THAT(*sent, HasSubstr(tree_of(dive.live().map(), Format::kBt)));
}

TEST(Ros2Options, FramesOfTfAreTwo) {
  for (const std::string address : {"/odom", "/tf", "/rov/tf:rov/odom:rov/base_link"}) {
    EXPECT_TRUE((LiveNav{LiveNav::Kind::kRos2, address}.validate())) << address;
  }
  for (const std::string address :
       {"", "tf", "/tf:", "/tf:map", "/tf::base_link", "/tf:map:", "/tf:map:odom:base", "/tf:odom:/odom", "/tf:/:odom",
        "/odom:map:base_link", "/", "/a b", "/a-b", "/a/", "//a", "/1a", "/a/1"}) {
    EXPECT_FALSE((LiveNav{LiveNav::Kind::kRos2, address}.validate())) << address;
  }
}

TEST(Ros2Options, TheNameOfATopicOfBeamsIsOneOfRos) {
  for (const std::string address : {"/scan_echo", "/rov/sonar2/echo", "/_a"}) {
    EXPECT_TRUE((LiveHead{.kind = LiveHead::Kind::kRos2, .address = address}.validate())) << address;
  }
  for (const std::string address : {"", "scan", "/", "/scan echo", "/scan/", "/scan-echo", "/2scan", "//scan"}) {
    EXPECT_FALSE((LiveHead{.kind = LiveHead::Kind::kRos2, .address = address}.validate())) << address;
  }
}

// It would follow its own poses.
TEST(Ros2Options, ThePublishedOdometryIsNotReadBack) {
  LiveOptions options = run_by("/odometry");
  EXPECT_TRUE(options.validate());
  options.publish.emplace();
  EXPECT_THAT(options.validate().error().message, HasSubstr("/odometry is what is published"));
  options.publish->prefix = "pingvox";
  EXPECT_TRUE(options.validate());
}

TEST(Ros2Options, AreRefusedWhereTheyCannotWork) {
  LiveOptions options;
  options.head.address = "udp://127.0.0.1:1";
  options.publish.emplace();
  EXPECT_TRUE(options.validate());
  options.map.depth = 12;
  options.ros2.domain = -1;
  EXPECT_THAT(options.validate().error().message, HasSubstr("16 levels, not of 12"));
  EXPECT_THAT(options.validate().error().message, HasSubstr("domain"));
}

TEST(Ros2Options, SayWhatIsMissingInABuildWithoutDds) {
  if (check_ros2_is_built()) GTEST_SKIP() << "this build has Cyclone DDS";
  const Result<Ros2Node> node = Ros2Node::open(loopback());
  ASSERT_FALSE(node);
  EXPECT_EQ(node.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(node.error().message, HasSubstr("cyclonedds-dev"));
}

}  // namespace
}  // namespace pingvox::test
