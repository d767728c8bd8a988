#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device/internal/ros2_node.hpp"
#include "io/internal/ros2_messages.hpp"
#include "live/dive.hpp"
#include "live/ros2_topics.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "support/ros_messages.hpp"

// What is said of topics of ROS 2 that are not there, not read, or published twice.
namespace pingvox::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Steps the run until an event of a kind comes, and returns that.
template <class Event, class Publish>
Event event_of(LiveMapping& live, Publish publish) {
  std::vector<Event> found;
  run_until(live, publish, [&] {
    if (found.empty()) found = events_of<Event>(live.take_events());
    return !found.empty();
  });
  return found.empty() ? Event() : found.front();
}

std::string odometry_at(double x, const std::string& frame = "odom", const std::string& child = "base_link") {
  const Pose pose = pose_from_rpy({x, 0.0, -1.0}, 0.0, 0.0, 0.0);
  return ros2_odometry(static_cast<std::uint64_t>(now_s() * 1e9), frame, child, pose, {});
}

TEST_F(Ros2, NavigationIsRefusedWithItsReason) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> poses = node().write({"/tf", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  const Result<Ros2Writer> inverted = node().write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  const Result<Ros2Writer> words = node().write({"/words", "std_msgs/msg/String"}, Ros2Delivery::kStream);
  const Result<Ros2Writer> damaged = node().write({"/damaged", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes && poses && inverted && words && damaged);
  const auto publish = [&](int) {
    EXPECT_TRUE(inverted->write(odometry_at(1.0, "base_link", "odom")));
    EXPECT_TRUE(damaged->write("\xff"));
  };
  for (const auto& [address, reason] : {std::pair("/tf:map:base_link", "frames are named of tf alone"),
                                        std::pair("/odom", "inverse of a pose of the vehicle"),
                                        std::pair("/words", "messages of std_msgs/msg/String are not read"),
                                        std::pair("/damaged", "does not fit its definition")}) {
    Result<LiveMapping> live = LiveMapping::open(run_by(address));
    ASSERT_TRUE(live) << live.error().message;
    const auto refused = event_of<live_event::MessagesRefused>(*live, publish);
    EXPECT_EQ(refused.device, std::string("ros2:") + address);
    EXPECT_THAT(refused.reason, HasSubstr(reason));
    EXPECT_FALSE(live->status().nav.front().is_connected);
  }
}

TEST_F(Ros2, DamagedMessagesOfASonarAreNoConnection) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes);
  LiveOptions options{.head = {.kind = LiveHead::Kind::kRos2, .address = "/scan_echo"}, .ros2 = loopback()};
  Result<LiveMapping> live = LiveMapping::open(options);
  ASSERT_TRUE(live) << live.error().message;
  const auto refused = event_of<live_event::MessagesRefused>(
      *live, [&](int i) { EXPECT_TRUE(echoes->write(echo(now_s(), i).substr(0, 30))); });
  EXPECT_EQ(refused.device, "ros2:/scan_echo");
  EXPECT_THAT(refused.reason, HasSubstr("does not fit its definition"));
  EXPECT_EQ(live->status().head.connections, 0U);
  // And it is one once they are good.
  event_of<live_event::Connected>(*live, [&](int i) { EXPECT_TRUE(echoes->write(echo(now_s(), i))); });
  EXPECT_TRUE(live->status().head.is_connected);
  EXPECT_EQ(live->status().head.refused, "");
}

std::string odometry_without_attitude() {
  std::string message = odometry_at(1.0);
  // The w of the quaternion, before two covariances and a twist.
  const std::size_t w_at = message.size() - (36 + 6 + 36 + 1) * sizeof(double);
  const double two = 2.0;
  std::memcpy(message.data() + w_at, &two, sizeof two);
  return message;
}

TEST_F(Ros2, WhyThereIsNoAttitudeIsSaid) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> poses = node().write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes && poses);
  Result<LiveMapping> live = LiveMapping::open(run_by("/odom"));
  ASSERT_TRUE(live) << live.error().message;
  const auto refused = event_of<live_event::MessagesRefused>(
      *live, [&](int) { EXPECT_TRUE(poses->write(odometry_without_attitude())); });
  EXPECT_EQ(refused.device, "ros2:/odom");
  EXPECT_EQ(refused.reason, "no attitude: the quaternion has the length 2, not 1");
}

TEST_F(Ros2, AnAttitudeThatAnotherTopicTellsIsNotMissed) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> poses = node().write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  const Result<Ros2Writer> turns = node().write({"/imu", "sensor_msgs/msg/Imu"}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes && poses && turns);
  LiveOptions options = run_by("/odom");
  options.nav.push_back({.kind = LiveNav::Kind::kRos2, .address = "/imu"});
  Result<LiveMapping> live = LiveMapping::open(options);
  ASSERT_TRUE(live) << live.error().message;
  const auto publish = [&](int) {
    EXPECT_TRUE(poses->write(odometry_without_attitude()));
    const bags::Bytes imu = bags::imu(now_s(), "imu_link", {0, 0, 0, 1}, {0, 0, 0}, 9.8);
    EXPECT_TRUE(turns->write(std::string(imu.begin(), imu.end())));
  };
  run_until(*live, publish, [&] { return !live->status().nav.front().no_attitude.empty(); });
  EXPECT_TRUE(events_of<live_event::MessagesRefused>(live->take_events()).empty());
  EXPECT_EQ(live->status().attitude, "/imu");
}

TEST_F(Ros2, TwoPublishersOfATopicAreNamed) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> filtered = node().write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  const Result<Ros2Writer> raw = node().write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes && filtered && raw);
  Result<LiveMapping> live = LiveMapping::open(run_by("/odom"));
  ASSERT_TRUE(live) << live.error().message;
  const auto several = event_of<live_event::SeveralPublishers>(*live, [&](int i) {
    EXPECT_TRUE(filtered->write(odometry_at(1.0)));
    if (i % 3 == 0) {
      EXPECT_TRUE(raw->write(odometry_at(1.5)));
    }
  });
  EXPECT_EQ(several.device, "ros2:/odom");
  EXPECT_EQ(several.publishers, 2U);
}

TEST_F(Ros2, APublisherThatIsRestartedIsNotTwo) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes);
  Result<LiveMapping> live = LiveMapping::open(run_by("/odom"));
  ASSERT_TRUE(live) << live.error().message;
  for (std::size_t run = 1; run <= 3; ++run) {
    const Result<Ros2Writer> poses = node().write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
    const std::size_t before = live->status().nav.front().messages;
    ASSERT_TRUE(poses);
    run_until(
        *live, [&](int) { EXPECT_TRUE(poses->write(odometry_at(1.0))); },
        [&] { return live->status().nav.front().messages >= before + 5; });
  }
  EXPECT_TRUE(events_of<live_event::SeveralPublishers>(live->take_events()).empty());
}

TEST_F(Ros2, NavigationMayBePublishedLater) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes);
  Result<LiveMapping> live = LiveMapping::open(run_by("/odom"));
  ASSERT_TRUE(live) << live.error().message;
  const auto missing =
      event_of<live_event::NotConnected>(*live, [&](int i) { EXPECT_TRUE(echoes->write(echo(now_s(), i))); });
  EXPECT_EQ(missing.device, "ros2:/odom");
  EXPECT_THAT(missing.reason, StartsWith("nobody publishes it"));
  const Result<Ros2Writer> poses = node().write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  ASSERT_TRUE(poses);
  event_of<live_event::Connected>(*live, [&](int) { EXPECT_TRUE(poses->write(odometry_at(1.0))); });
  EXPECT_TRUE(live->status().nav.front().is_connected);
}

TEST_F(Ros2, TheWaitForATopicOfBeamsEndsWhenItIsAsked) {
  LiveOptions options{.head = {.kind = LiveHead::Kind::kRos2, .address = "/scan_echo"}, .ros2 = loopback()};
  std::string told;
  const Result<LiveMapping> live = LiveMapping::open(options, nullptr, [&](const std::string& problem) {
    told = problem;
    return problem.empty();
  });
  ASSERT_FALSE(live);
  EXPECT_EQ(live.error().code, Error::Code::kIo);
  EXPECT_EQ(told, live.error().message);
  EXPECT_THAT(told, StartsWith("ros2:/scan_echo: nobody publishes it"));
}

// More than ten seconds may pass until a node is started.
TEST_F(Ros2, TheWaitForATopicOfBeamsEndsWithItsPublisher) {
  LiveOptions options{.head = {.kind = LiveHead::Kind::kRos2, .address = "/scan_echo"}, .ros2 = loopback()};
  std::optional<Result<Ros2Writer>> echoes;
  const Result<LiveMapping> live = LiveMapping::open(options, nullptr, [&](const std::string&) {
    if (!echoes) echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
    return true;
  });
  EXPECT_TRUE(live);
}

TEST_F(Ros2, WhatIsThereInPlaceOfATopicIsSaid) {
  const Ros2Topic own{"/own", "std_msgs/msg/String"}, words{"/words", "std_msgs/msg/String"};
  const Result<Ros2Node> other = Ros2Node::open(loopback());
  ASSERT_TRUE(other);
  const Result<Ros2Writer> own_writer = node().write(own, Ros2Delivery::kStream);
  const Result<Ros2Writer> writer = other->write(words, Ros2Delivery::kStream);
  ASSERT_TRUE(own_writer && writer);
  std::string seen;
  for (const double end_s = now_s() + kPatience_s; seen.find("/words") == std::string::npos && now_s() < end_s;) {
    seen = why_not_published(node());
  }
  EXPECT_THAT(seen, AllOf(HasSubstr("in domain " + std::to_string(own_domain())), HasSubstr("/words")));
  EXPECT_THAT(seen, Not(HasSubstr("/own")));
}

TEST_F(Ros2, WhatIsNotReadIsRefused) {
  const Result<Ros2Writer> writer = node().write({"/words", "std_msgs/msg/String"}, Ros2Delivery::kStream);
  ASSERT_TRUE(writer);
  LiveOptions options{.head = {.kind = LiveHead::Kind::kRos2, .address = "/words"}, .ros2 = loopback()};
  const Result<LiveMapping> live = LiveMapping::open(options);
  ASSERT_FALSE(live);
  EXPECT_EQ(live.error().message.substr(0, live.error().message.find(" are")),
            "ros2:/words: messages of std_msgs/msg/String");
}

}  // namespace
}  // namespace pingvox::test
