#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "device/internal/ros2_node.hpp"
#include "io/internal/ros2_messages.hpp"
#include "live/dive.hpp"
#include "live/ros2_publisher.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "support/bag_writer.hpp"
#include "support/ros_messages.hpp"

namespace pingvox::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// One that no vehicle has, of this process: tests that run at the same time do not hear each other.
int own_domain() {
  constexpr int kFirst = 60, kDomains = 30;
  return kFirst + static_cast<int>(::getpid() % kDomains);
}
constexpr double kPatience_s = 10.0;

Ros2Network loopback() {
  return {.domain = own_domain(), .interface = "lo"};
}

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

/// Tests that need Cyclone DDS, and a loopback interface that it can use.
class Ros2 : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto built = check_ros2_is_built(); !built) GTEST_SKIP() << built.error().message;
    node_ = Ros2Node::open(loopback());
    if (!node_) GTEST_SKIP() << node_.error().message;
  }

  const Ros2Node& node() const { return *node_; }

  Ros2Reader reader_of(const std::string& topic, const std::string& type, Ros2Delivery delivery) const {
    Result<Ros2Reader> reader = node().read({topic, type}, delivery);
    EXPECT_TRUE(reader);
    return *reader;
  }

 private:
  Result<Ros2Node> node_ = fail(Error::Code::kIo, "not opened");
};

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

/// Puts a message together in CDR.
class CdrText {
 public:
  template <class T>
  CdrText& number(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back('\0');
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), &value, sizeof(T));
    bytes_.append(raw.data(), raw.size());
    return *this;
  }
  CdrText& header(double stamp_s, const std::string& frame) {
    const double whole_s = std::floor(stamp_s);
    number(static_cast<std::int32_t>(whole_s)).number(static_cast<std::uint32_t>((stamp_s - whole_s) * 1e9));
    number(static_cast<std::uint32_t>(frame.size() + 1));
    bytes_.append(frame.c_str(), frame.size() + 1);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_ = std::string("\0\1\0\0", 4);
};

constexpr int kEchoesOfTurn = 100;
const std::string kEchoType = "ping360_sonar_msgs/msg/SonarEcho";

/// Of a wall 5 m around the head.
std::string echo(double stamp_s, int step) {
  constexpr std::uint32_t kSamples = 100;
  CdrText message;
  const double angle_rad = 2.0 * std::numbers::pi * (step % kEchoesOfTurn) / kEchoesOfTurn;
  message.header(stamp_s, "sonar").number(static_cast<float>(angle_rad)).number(std::uint8_t{1});
  message.number(static_cast<std::uint16_t>(kSamples)).number(std::uint16_t{750}).number(std::uint16_t{1500});
  message.number(std::uint8_t{10}).number(kSamples);
  for (std::uint32_t i = 0; i < kSamples; ++i) message.number(static_cast<std::uint8_t>(i / 5 == 10 ? 220 : 7));
  return message.bytes();
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Publishes `message(i)` and steps the run, until it holds or the patience ends.
template <class Publish, class Done>
void run_until(LiveMapping& live, Publish publish, Done is_done) {
  const double end_s = now_s() + 60.0;
  for (int i = 0; !is_done() && now_s() < end_s; ++i) {
    publish(i);
    // No node publishes tens of thousands of poses in a second, which are refused.
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    live.wait(0.01);
    ASSERT_TRUE(live.step());
  }
  EXPECT_TRUE(is_done());
}

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

/// A run by tf, with a map of what is in it.
LiveOptions run_by(const std::string& address) {
  return {.head = {.kind = LiveHead::Kind::kRos2, .address = "/scan_echo"},
          .nav = {{.kind = LiveNav::Kind::kRos2, .address = address}},
          .ros2 = loopback()};
}

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
