// Which source of a log tells where the vehicle was, and in which frame.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "call.hpp"
#include "tests/support/ros_messages.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kPi = std::numbers::pi;
constexpr std::string_view kPoseStamped = "geometry_msgs/msg/PoseStamped", kOdometry = "nav_msgs/msg/Odometry",
                           kTf = "tf2_msgs/msg/TFMessage";

/// A bag of three turns of a sonar in 24 s, whose echo is nearer to starboard, and of navigation.
class DiveBag {
 public:
  DiveBag() {
    mcap_.topic(1, "/echo", "ping360_sonar_msgs/msg/SonarEcho", "");
    for (int i = 0; i < 96; ++i) {
      const double angle_rad = i % 32 / 32.0 * 2.0 * kPi, time_s = 1000.0 + 0.25 * i;
      // As the head counts: clockwise, 0 astern.
      const std::size_t bin = angle_rad > kPi && angle_rad < 1.9 * kPi ? 9 : 17;
      add(1, time_s, bags::sonar_echo(time_s, "sonar_link", static_cast<float>(angle_rad), bin));
    }
  }

  void topic(std::uint16_t id, std::string_view name, std::string_view type) { mcap_.topic(id, name, type, ""); }
  void add(std::uint16_t id, double time_s, const bags::Bytes& message) {
    mcap_.message(id, bags::nanoseconds(time_s), message);
  }
  /// A message each tenth of a second.
  void add_each(std::uint16_t id, const std::function<bags::Bytes(double)>& message, double step_s = 0.1) {
    const long count = std::lround(27.0 / step_s);
    for (long i = 0; i < count; ++i) {
      const double time_s = 999.0 + step_s * static_cast<double>(i);
      add(id, time_s, message(time_s));
    }
  }
  std::string file() && {
    mcap_.end_chunk();
    const bags::Bytes bytes = mcap_.closed();
    return {bytes.begin(), bytes.end()};
  }

 private:
  bags::Mcap mcap_;
};

/// North at 0.1 m/s in 5 m of depth.
std::vector<double> vehicle_at(double time_s) {
  return bags::pose_numbers(0.0, 0.1 * (time_s - 1000.0), -5.0, kPi / 2);
}

Outcome map_with_itself(const Workplace& here, const std::string& bag, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"map", bag, "--nav", bag, "-o", bag + ".bt", "--beam", "ray"};
  words.insert(words.end(), more.begin(), more.end());
  return here.call(words);
}

// `pose_gt_ned` of uuv_simulator: the map was mirrored, and 5 m above the water.
TEST(NavSources, OdometryInNedMakesTheSameMap) {
  const Workplace here;
  for (const char* name : {"enu.mcap", "ned.mcap"}) {
    const bool is_ned = name == std::string("ned.mcap");
    DiveBag bag;
    bag.topic(2, "/pose_gt", kOdometry);
    bag.add_each(2, [&](double time_s) {
      return is_ned ? bags::odometry(time_s, "world_ned", "base_link_ned", bags::pose_numbers(0, 0, 5, kPi / 6))
                    : bags::odometry(time_s, "odom", "base_link", bags::pose_numbers(0, 0, -5, kPi / 3));
    });
    here.write(name, std::move(bag).file());
  }
  const Outcome enu = map_with_itself(here, "enu.mcap"), ned = map_with_itself(here, "ned.mcap");
  ASSERT_EQ(ned.status, 0) << ned.err;
  EXPECT_EQ(here.call({"compare", "enu.mcap.bt", "ned.mcap.bt"}).status, 0);
  EXPECT_THAT(ned.out, HasSubstr("/pose_gt: turned from world_ned (north, east, down) and base_link_ned"));
  EXPECT_THAT(enu.out, HasSubstr("origin and axes are those of /pose_gt\n"));
  EXPECT_THAT(here.call({"info", "ned.mcap"}).out, HasSubstr("/pose_gt: turned from world_ned"));
}

// Goals became the path, and tf was gone.
TEST(NavSources, AClickedGoalIsNotThePath) {
  const Workplace here;
  DiveBag bag;
  bag.topic(2, "/tf", kTf);
  bag.topic(3, "/goal_pose", kPoseStamped);
  bag.add_each(2, [](double time_s) { return bags::transforms(time_s, {{"odom", "base_link", vehicle_at(time_s)}}); });
  bag.add_each(
      3, [](double time_s) { return bags::pose_stamped(time_s, "map", bags::pose_numbers(10.0 * time_s, 3, 0, 0)); },
      9.0);
  here.write("goal.mcap", std::move(bag).file());
  const Outcome mapped = map_with_itself(here, "goal.mcap");
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("poses from /tf:odom:base_link\n"));
  EXPECT_THAT(mapped.out, HasSubstr("nav others  /goal_pose (3 samples: a goal, command or plan by its name)\n"));
}

// The pose of a marker in the camera's frame came more often than the odometry.
TEST(NavSources, AMarkerIsNotThePathUnlessItIsChosen) {
  const Workplace here;
  DiveBag bag;
  bag.topic(2, "/odom", kOdometry);
  bag.topic(3, "/box/pose", kPoseStamped);
  bag.add_each(2, [](double time_s) { return bags::odometry(time_s, "odom", "base_link", vehicle_at(time_s)); });
  bag.add_each(
      3,
      [](double time_s) {
        return bags::pose_stamped(time_s, "camera_optical", bags::pose_numbers(0.2 + 0.001 * time_s, 0.1, 1.5, 0.3));
      },
      0.05);
  here.write("box.mcap", std::move(bag).file());
  Outcome mapped = map_with_itself(here, "box.mcap", {"--json"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr(R"("attitude": "/odom", "position": "/odom")"));
  EXPECT_THAT(mapped.out, HasSubstr("\"others\": [\n"
                                    R"({"name": "/box/pose", "samples": 540, "frame": "camera_optical", )"
                                    R"("note": "camera_optical moves with the vehicle"})"));
  mapped = map_with_itself(here, "box.mcap", {"--nav-source", "/box/pose"});
  EXPECT_THAT(mapped.out, HasSubstr("poses from /box/pose\n")) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("nav others  /odom (270 samples"));
  mapped = map_with_itself(here, "box.mcap", {"--nav-source", "attitude=/box/pose"});
  EXPECT_THAT(mapped.out, HasSubstr("poses from /box/pose and /odom\n")) << mapped.err;
  // Kills a source that is taken without a word where nothing is made of it.
  mapped = map_with_itself(here, "box.mcap", {"--nav-source", "velocity=/odom", "--nav-source", "position=/box/pose"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.err, HasSubstr("--nav-source velocity=/odom: has no effect, the path is from "));
  EXPECT_THAT(mapped.err, testing::Not(HasSubstr("--nav-source position=")));
  expect_error(map_with_itself(here, "box.mcap", {"--nav-source", "/nope"}), 2,
               {"--nav-source", "no source '/nope', but /box/pose (position, attitude), /odom (position, attitude"});
  // Each command that makes a path takes the option.
  ASSERT_EQ(here.call({"convert", "box.mcap", "-o", "box.tum", "--nav-source", "/box/pose"}).status, 0);
  EXPECT_THAT(here.read("box.tum"), HasSubstr(" 0.1 1.5 "));
  ASSERT_EQ(here.call({"convert", "box.mcap", "-o", "odom.tum"}).status, 0);
  EXPECT_THAT(here.read("odom.tum"), HasSubstr(" -5 "));
  expect_error(here.call({"convert", "box.mcap", "-o", "box.csv", "--nav-source", "/odom"}), 2, {"--nav-source"});
  EXPECT_EQ(here.call({"render", "box.mcap", "--nav", "box.mcap", "--nav-source", "/odom", "--view", "above", "-o",
                       "box.png"})
                .status,
            0);
  for (std::vector<std::string> words :
       {std::vector<std::string>{"slam"}, std::vector<std::string>{"locate", "--map", "box.mcap.bt"}}) {
    words.insert(words.end(), {"box.mcap", "--nav", "box.mcap", "-o", "o.tum", "--nav-source", "/nope"});
    expect_error(here.call(words), 2, {"no source '/nope'"});
  }
  expect_error(here.call({"map", "box.mcap", "-o", "o.bt", "--nav-source", "/odom"}), 2, {"--nav-source", "--nav"});
}

// All beams lay in a strip: where the head looked was taken as the vehicle's attitude, and `map` advised it.
TEST(NavSources, TheHeadingOfTheHeadIsNotTheVehicles) {
  const Workplace here;
  DiveBag bag;
  bag.topic(2, "/tritech_micron/heading", kPoseStamped);
  bag.add_each(
      2,
      [](double time_s) {
        return bags::pose_stamped(time_s, "micron", bags::pose_numbers(0, 0, 0, (time_s - 1000.0) / 8.0 * 2.0 * kPi));
      },
      0.25);
  here.write("head.mcap", std::move(bag).file());
  EXPECT_THAT(here.call({"map", "head.mcap", "-o", "head.bt"}).err, Not(HasSubstr("--nav")));
  expect_error(map_with_itself(here, "head.mcap"), 1,
               {"gives no path", "/tritech_micron/heading (108 samples: a heading without a place", "--nav-source"});
  EXPECT_THAT(here.call({"info", "head.mcap"}).out, HasSubstr("not taken   /tritech_micron/heading"));
}

TEST(NavSources, TransformsThatAreNotJoinedAreNamed) {
  const Workplace here;
  DiveBag bag;
  bag.topic(2, "/tf", kTf);
  bag.add_each(2, [](double time_s) {
    return bags::transforms(time_s, {{"map", "odom", vehicle_at(time_s)}, {"base", "base_link", vehicle_at(time_s)}});
  });
  here.write("tf.mcap", std::move(bag).file());
  expect_error(map_with_itself(here, "tf.mcap"), 1, {"gives no path", "/tf: tf does not join base_link to map"});
  EXPECT_THAT(here.call({"info", "tf.mcap"}).out, HasSubstr("tf does not join base_link to map"));
}

TEST(NavSources, AMountThatTfTellsIsNamedWhereNoneWasGiven) {
  const Workplace here;
  DiveBag bag;
  bag.topic(2, "/odom", kOdometry);
  bag.topic(3, "/tf_static", kTf);
  bag.add_each(2, [](double time_s) { return bags::odometry(time_s, "odom", "base_link", vehicle_at(time_s)); });
  bag.add(3, 999.0, bags::transforms(999.0, {{"base_link", "sonar_link", bags::pose_numbers(0.25, 0, -0.5, kPi / 2)}}));
  here.write("mount.mcap", std::move(bag).file());
  EXPECT_THAT(map_with_itself(here, "mount.mcap").err,
              HasSubstr("/tf has the sonar's frame sonar_link on base_link, which is not used: --mount "
                        "0.25,0,-0.5,0,0,90\n"));
  EXPECT_THAT(map_with_itself(here, "mount.mcap", {"--mount", "0.25,0,-0.5,0,0,90"}).err,
              Not(HasSubstr("the sonar's frame")));
}

/// Samples of a CSV log at 10 Hz.
std::string csv_of(std::string_view source, std::string_view quantity, int from_s, int to_s) {
  std::string text;
  for (int i = 10 * from_s; i < 10 * to_s; ++i) {
    const double time_s = 0.1 * i;
    const double turned_rad = quantity == "attitude" ? 0.02 * time_s : 0.0;
    text += fmt::format("{:.1f},{},{},0,0,{}\n", time_s, source, quantity, turned_rad);
  }
  return text;
}

// The last log of --nav decided which attitude was taken, also one that ended before the dive.
TEST(NavSources, TheOrderOfTheLogsDoesNotMatter) {
  const Workplace here;
  here.simulate_tank();
  const std::string head = "time_s,source,quantity,x,y,z\n";
  here.write("position.csv",
             head + csv_of("LOCAL_POSITION_NED", "position", -5, 60) + csv_of("ATTITUDE", "attitude", -5, -2));
  here.write("attitude.csv", head + csv_of("ATT", "attitude", -5, 60));
  const Outcome one = here.call({"map", "tank.csv", "-o", "one.bt", "--nav", "position.csv", "--nav", "attitude.csv"});
  const Outcome other =
      here.call({"map", "tank.csv", "-o", "other.bt", "--nav", "attitude.csv", "--nav", "position.csv"});
  ASSERT_EQ(one.status, 0) << one.err;
  ASSERT_EQ(other.status, 0) << other.err;
  EXPECT_THAT(one.out, HasSubstr("from ATT and LOCAL_POSITION_NED\n"));
  EXPECT_THAT(one.out, HasSubstr("nav others  ATTITUDE (30 samples)\n"));
  EXPECT_EQ(here.call({"compare", "one.bt", "other.bt"}).status, 0);
}

// Commands came more often than the depth of the vehicle: the map was 15 m too low.
TEST(NavSources, ADepthThatIsACommandIsLeftAside) {
  const Workplace here;
  DiveBag bag;
  bag.topic(2, "/fix", "sensor_msgs/msg/NavSatFix");
  bag.topic(3, "/imu", "sensor_msgs/msg/Imu");
  bag.topic(4, "/desired_depth", "std_msgs/msg/Float64");
  bag.topic(5, "/bar30/depth", "std_msgs/msg/Float64");
  bag.add_each(3, [](double time_s) { return bags::imu(time_s, "imu_link", {0, 0, 0, 1}, {0, 0, 0}); });
  bag.add_each(2, [](double time_s) { return bags::nav_sat_fix(time_s, 54.3 + 1e-7 * time_s, 10.1); });
  bag.add_each(4, [](double) { return bags::Cdr().numbers({20.0}).bytes(); }, 0.02);
  bag.add_each(5, [](double) { return bags::Cdr().numbers({5.0}).bytes(); });
  here.write("depth.mcap", std::move(bag).file());
  const Outcome mapped = map_with_itself(here, "depth.mcap");
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("from /imu and /fix, depth by /bar30/depth\n"));
  EXPECT_THAT(mapped.out,
              HasSubstr("nav others  /desired_depth (1350 samples: a goal, command or plan by its name)\n"));
  EXPECT_THAT(map_with_itself(here, "depth.mcap", {"--nav-source", "depth=/desired_depth"}).out,
              HasSubstr("depth by /desired_depth\n"));
}

// "398 of 400 beams outside", then an empty map.
TEST(NavSources, PosesInUtmAreToldWithTheirDistance) {
  const Workplace here;
  DiveBag bag;
  bag.topic(2, "/odom", kOdometry);
  bag.add_each(2, [](double time_s) {
    return bags::odometry(time_s, "utm", "base_link", bags::pose_numbers(500'000, 6'010'000, -5, kPi / 3));
  });
  here.write("utm.mcap", std::move(bag).file());
  expect_error(map_with_itself(here, "utm.mcap"), 1,
               {"utm.mcap: the poses are 6030.76 km from the origin", "--depth 32"});
  EXPECT_EQ(here.call({"map", "utm.mcap", "--nav", "utm.mcap", "--depth", "32", "-o", "utm.pvx"}).status, 0);
}

// "no valid position or velocity", but not why.
TEST(NavSources, ALogWhoseLinesAreSkippedNamesTheFirst) {
  const Workplace here;
  here.simulate_tank();
  here.write("nav.csv", "time_s,source,quantity,x,y,z\n0,P,pose,0,0,0\n1,P,pose,0,0,0\n");
  expect_error(here.call({"map", "tank.csv", "-o", "m.bt", "--nav", "nav.csv"}), 1,
               {"2 of 2 lines are not samples, the first: line 2: quantity 'pose' is not one of"});
}

}  // namespace
}  // namespace pingvox::test
