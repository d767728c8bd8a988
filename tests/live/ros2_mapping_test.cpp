#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/internal/ros2_messages.hpp"
#include "live/dive.hpp"
#include "live/ros2_topics.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "support/bag_writer.hpp"

// Runs by topics of ROS 2: where the beams are put, by which poses and clocks.
namespace pingvox::test {
namespace {

TEST_F(Ros2, APlayedBagGivesTheMapOfTheBag) {
  constexpr int kEchoes = 3 * kEchoesOfTurn;
  const Result<Ros2Writer> writer = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  ASSERT_TRUE(writer);
  LiveOptions options{.head = {.kind = LiveHead::Kind::kRos2, .address = "/scan_echo"}, .ros2 = loopback()};
  options.map.resolution_m = 0.1;
  Result<LiveMapping> live = LiveMapping::open(options);
  ASSERT_TRUE(live) << live.error().message;
  bags::Mcap bag;
  bag.topic(1, "/scan_echo", kEchoType, "");
  const double start_s = now_s();
  int sent = 0;
  const auto publish = [&](int) {
    const double stamp_s = start_s + 0.01 * sent;
    const std::string message = echo(stamp_s, sent++);
    EXPECT_TRUE(writer->write(message));
    bag.message(1, static_cast<std::uint64_t>(stamp_s * 1e9), bags::Bytes(message.begin(), message.end()));
  };
  run_until(*live, publish, [&] { return sent == kEchoes; });
  ASSERT_TRUE(live->finish());
  EXPECT_EQ(live->status().beams, static_cast<std::size_t>(kEchoes));
  bag.end_chunk();
  const Result<std::unique_ptr<BeamSource>> log = open_beams(FileBytes{"bag.mcap", bag.closed()});
  ASSERT_TRUE(log) << log.error().message;
  OccupancyMap map({.resolution_m = 0.1});
  BuildOptions build;
  build.model = HeadOptions().apply_to(build.model, (*log)->device());
  ASSERT_TRUE(build_map(**log, Trajectory::still(Pose::Identity()), build, map));
  EXPECT_FALSE(map.empty());
  EXPECT_EQ(bytes_of(live->map()), bytes_of(map));
}

TEST_F(Ros2, OdometryPutsBeamsWhereTheVehicleIs) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> poses = node().write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes && poses);
  LiveOptions options{.head = {.kind = LiveHead::Kind::kRos2, .address = "/scan_echo"},
                      .nav = {{.kind = LiveNav::Kind::kRos2, .address = "/odom"}},
                      .ros2 = loopback()};
  Result<LiveMapping> live = LiveMapping::open(options);
  ASSERT_TRUE(live) << live.error().message;
  const Pose where = pose_from_rpy({3.0, 2.0, -1.0}, 0.0, 0.0, 0.5);
  const auto publish = [&](int i) {
    const auto time_ns = static_cast<std::uint64_t>(now_s() * 1e9);
    EXPECT_TRUE(poses->write(ros2_odometry(time_ns, "odom", "base_link", where, {})));
    std::string message = echo(now_s(), i);
    EXPECT_TRUE(echoes->write(message));
    // Cut off, and with more samples than there are bytes.
    if (i % 10 == 0) {
      EXPECT_TRUE(echoes->write(message.substr(0, 30)));
      EXPECT_TRUE(poses->write("\xff"));
    }
    if (i % 10 == 5) {
      EXPECT_TRUE(echoes->write(message.replace(message.size() - 104, 4, "\xff\xff\xff\x7f")));
    }
  };
  run_until(*live, publish, [&] { return live->report().beams >= kEchoesOfTurn; });
  const std::optional<StampedPose> pose = live->pose();
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->map_from_body.isApprox(where, 1e-6));
  EXPECT_GT(live->status().head.damaged, 0U);
  EXPECT_GT(live->status().nav.front().damaged, 0U);
  EXPECT_EQ(live->status().position, "/odom");
  ASSERT_TRUE(live->finish());
  EXPECT_EQ(live->map().classify({3.0, 2.0, -1.0}), Occupancy::kFree);
}

/// 50 times a second: more beams would not wait for their poses.
template <class Publish>
auto paced(Publish publish) {
  constexpr double kEvery_s = 0.02;
  return [=, due_s = 0.0, sent = 0](int) mutable {
    if (now_s() < due_s) return;
    due_s = now_s() + kEvery_s;
    publish(sent++);
  };
}

/// The events of a run whose odometry has another clock than its sonar, until one of a kind has come.
template <class Event>
std::vector<LiveEvent> events_with_clock(const Ros2Node& node, double ahead_s) {
  const Result<Ros2Writer> echoes = node.write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> poses = node.write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  EXPECT_TRUE(echoes && poses);
  const LiveOptions options{.head = {.kind = LiveHead::Kind::kRos2, .address = "/scan_echo"},
                            .nav = {{.kind = LiveNav::Kind::kRos2, .address = "/odom"}},
                            .ros2 = loopback()};
  Result<LiveMapping> live = LiveMapping::open(options);
  EXPECT_TRUE(live) << live.error().message;
  std::vector<LiveEvent> events;
  if (!live) return events;
  const auto publish = [&](int i) {
    const auto time_ns = static_cast<std::uint64_t>((now_s() + ahead_s) * 1e9);
    EXPECT_TRUE(poses->write(ros2_odometry(time_ns, "odom", "base_link", Pose::Identity(), {})));
    EXPECT_TRUE(echoes->write(echo(now_s(), i)));
  };
  const auto has_come = [&] {
    for (LiveEvent& event : live->take_events()) events.push_back(std::move(event));
    return !events_of<Event>(events).empty();
  };
  run_until(*live, paced([&](int i) { publish(i); }), has_come);
  return events;
}

TEST_F(Ros2, StampsThatAreAheadOfThoseOfTheSonarAreTold) {
  const std::vector<LiveEvent> events = events_with_clock<live_event::ClocksDiffer>(node(), 3.0);
  const auto differ = events_of<live_event::ClocksDiffer>(events);
  ASSERT_FALSE(differ.empty());
  EXPECT_EQ(differ.front().device, "ros2:/odom");
  EXPECT_EQ(differ.front().head, "ros2:/scan_echo");
  EXPECT_NEAR(differ.front().ahead_s, 3.0, 0.3);
  EXPECT_TRUE(events_of<live_event::BeamsWithoutPose>(events).empty()) << "they have wrong ones";
}

TEST_F(Ros2, PosesThatAreBehindTheBeamsAreTold) {
  const std::vector<LiveEvent> events = events_with_clock<live_event::BeamsWithoutPose>(node(), -3.0);
  const auto lost = events_of<live_event::BeamsWithoutPose>(events);
  ASSERT_FALSE(lost.empty());
  EXPECT_NEAR(lost.front().behind_s.value_or(0.0), 3.0, 0.3);
  // The first beams are held until their angles are judged, and get poses: that the clocks differ may be found before.
  for (const auto& differ : events_of<live_event::ClocksDiffer>(events)) EXPECT_NEAR(differ.ahead_s, -3.0, 0.3);
}

// Kills what depends on the clock of this host.
TEST_F(Ros2, AVehicleWithAnotherClockIsMapped) {
  constexpr double kBehind_s = 20.0;
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> poses = node().write({"/odom", "nav_msgs/msg/Odometry"}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes && poses);
  Result<LiveMapping> live = LiveMapping::open({.head = {.kind = LiveHead::Kind::kRos2, .address = "/scan_echo"},
                                                .nav = {{.kind = LiveNav::Kind::kRos2, .address = "/odom"}},
                                                .ros2 = loopback()});
  ASSERT_TRUE(live) << live.error().message;
  const auto publish = [&](int i) {
    EXPECT_TRUE(echoes->write(echo(now_s() - kBehind_s, i)));
    if (i % 5 != 0) return;
    const auto time_ns = static_cast<std::uint64_t>((now_s() - kBehind_s) * 1e9);
    EXPECT_TRUE(poses->write(ros2_odometry(time_ns, "odom", "base_link", Pose::Identity(), {})));
  };
  run_until(*live, paced([&](int i) { publish(i); }), [&] { return live->report().beams >= 3 * kEchoesOfTurn; });
  EXPECT_TRUE(events_of<live_event::PosesEnded>(live->take_events()).empty());
  EXPECT_LT(live->status().without_pose, live->report().beams);
}

const std::string kTfType = "tf2_msgs/msg/TFMessage";

TEST_F(Ros2, TfPutsBeamsWhereTheVehicleIs) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> moving = node().write({"/tf", kTfType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> still = node().write({"/tf_static", kTfType}, Ros2Delivery::kKeepsLast);
  ASSERT_TRUE(echoes && moving && still);
  const Pose map_from_odom = pose_from_rpy({3.0, 2.0, 0.0}, 0.0, 0.0, 0.5);
  const Pose odom_from_base = pose_from_rpy({0.5, 0.0, -1.0}, 0.1, 0.0, 0.0);
  const Pose base_from_link = pose_from_rpy({0.0, 0.2, 0.0}, 0.0, 0.0, 0.0);
  // Long before anybody listens.
  EXPECT_TRUE(still->write(ros2_transform(0, "base", "base_link", base_from_link)));
  LiveOptions options = run_by("/tf");
  options.publish.emplace();
  Result<LiveMapping> live = LiveMapping::open(options);
  ASSERT_TRUE(live) << live.error().message;
  const Ros2Reader tf = reader_of("/tf", kTfType, Ros2Delivery::kStream);
  bool is_placed_again = false;
  const auto publish = [&](int i) {
    const auto time_ns = static_cast<std::uint64_t>(now_s() * 1e9);
    EXPECT_TRUE(moving->write(ros2_transform(time_ns, "map", "odom", map_from_odom)));
    EXPECT_TRUE(moving->write(ros2_transform(time_ns, "odom", "base", odom_from_base)));
    if (i % 10 == 0) {
      EXPECT_TRUE(moving->write("\xff"));
    }
    EXPECT_TRUE(echoes->write(echo(now_s(), i)));
    while (const std::optional<std::string> message = tf.take(0.0)) {
      is_placed_again = is_placed_again || message->find("base_link") != std::string::npos;
    }
  };
  run_until(*live, publish, [&] { return live->report().beams >= kEchoesOfTurn; });
  const std::optional<StampedPose> pose = live->pose();
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->map_from_body.isApprox(map_from_odom * odom_from_base * base_from_link, 1e-6));
  EXPECT_EQ(live->status().position, "/tf:map:base_link");
  EXPECT_TRUE(live->status().nav.front().is_connected);
  EXPECT_GT(live->status().nav.front().damaged, 0U);
  EXPECT_FALSE(is_placed_again) << "a second parent of base_link";
  ASSERT_TRUE(live->finish());
}

TEST_F(Ros2, WhyTfTellsNoPoseIsSaid) {
  const Result<Ros2Writer> echoes = node().write({"/scan_echo", kEchoType}, Ros2Delivery::kStream);
  const Result<Ros2Writer> moving = node().write({"/tf", kTfType}, Ros2Delivery::kStream);
  ASSERT_TRUE(echoes && moving);
  Result<LiveMapping> live = LiveMapping::open(run_by("/tf:map:base_link"));
  ASSERT_TRUE(live) << live.error().message;
  const auto publish = [&](int) {
    const auto time_ns = static_cast<std::uint64_t>(now_s() * 1e9);
    EXPECT_TRUE(moving->write(ros2_transform(time_ns, "odom", "base_link", Pose::Identity())));
  };
  run_until(*live, publish, [&] { return !live->status().nav.front().problem.empty(); });
  EXPECT_EQ(live->status().nav.front().problem, "tf does not join base_link to map");
  EXPECT_FALSE(live->status().nav.front().is_connected);
  EXPECT_FALSE(live->pose());
}

}  // namespace
}  // namespace pingvox::test
