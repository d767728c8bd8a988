// Navigation that jumps: what no vehicle can do is left out, and said with time and size.

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <functional>
#include <sstream>
#include <string>
#include <thread>

#include "call.hpp"
#include "json_reader.hpp"
#include "live_head.hpp"
#include "mavlink_messages.hpp"

namespace pingvox::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kStart_s = 1'700'000'000.0;

/// 30 s of beams of a head that turns, with a wall all around at 3 m.
std::string turning_head() {
  std::string log = "time_s,bearing_deg,bin_length_m,intensities\n";
  for (int i = 0; i < 300; ++i) {
    log += fmt::format("{:.2f},{},0.1", kStart_s + 0.05 + 0.1 * i, (9 * i) % 360);
    for (int bin = 0; bin < 40; ++bin) log += bin == 30 ? ",200" : ",0";
    log += '\n';
  }
  return log;
}

/// 30 s of an autopilot's log, ten times a second.
std::string tlog_of(const std::function<std::string(std::uint32_t, int)>& position) {
  std::string log;
  for (int i = 0; i < 300; ++i) {
    const auto boot_ms = static_cast<std::uint32_t>(100'000 + 100 * i);
    log += tlog_record(kStart_s + 0.1 * i, mavlink_attitude(boot_ms));
    log += tlog_record(kStart_s + 0.1 * i, position(boot_ms, i));
  }
  return log;
}

std::string stepping_position(std::uint32_t boot_ms, int i, int from, int to) {
  return mavlink_position(boot_ms, 1.0F + 0.01F * static_cast<float>(i) + (i >= from && i < to ? 40.0F : 0.0F), 0.0F,
                          2.0F);
}

/// A number of a corner of the map.
double corner_m(const std::string& map_json, const char* corner, int axis) {
  auto json = flat_json(map_json);
  EXPECT_TRUE(json) << map_json;
  std::istringstream numbers((*json)[corner].substr(1));
  double number = 0.0;
  char comma = 0;
  for (int i = 0; i <= axis; ++i) numbers >> number >> comma;
  return number;
}

/// From south to north.
double extent_m(const std::string& map_json) {
  return corner_m(map_json, "map.bounds.max", 1) - corner_m(map_json, "map.bounds.min", 1);
}

Outcome map_with(const Workplace& here, const char* option, const char* file) {
  return here.call(
      {"map", "beams.csv", option, file, "-o", "map.bt", "--beam", "ray", "--resolution", "0.1", "--json"});
}

// The origin of the filter was set anew: two maps in one, 40 m apart, without a word.
TEST(Steps, OfAPositionAreLeftOutAndSaid) {
  const Workplace here;
  here.write("beams.csv", turning_head());
  here.write("dive.tlog", tlog_of([](std::uint32_t ms, int i) { return stepping_position(ms, i, 200, 300); }));
  const Outcome mapped = map_with(here, "--nav", "dive.tlog");
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.err, HasSubstr("dive.tlog: position of LOCAL_POSITION_NED jumps by 40.0 m in 0.10 s at "
                                    "1700000020.000 s: 100 of 300 samples are dropped, those from 1700000020.000 to "
                                    "1700000029.900 s\n"));
  EXPECT_THAT(mapped.err, HasSubstr("101 of 300 beams outside the time of the poses"));
  EXPECT_THAT(mapped.err, HasSubstr("data after a jump is dropped"));
  EXPECT_LT(extent_m(mapped.out), 10.0);

  const Outcome text = here.call({"info", "dive.tlog"});
  EXPECT_THAT(text.out, HasSubstr("position of LOCAL_POSITION_NED jumps by 40.0 m in 0.10 s"));
  const Outcome json = here.call({"info", "dive.tlog", "--json"});
  EXPECT_THAT(json.out, HasSubstr(R"("left_out": 100)"));
  EXPECT_THAT(json.out, HasSubstr(R"("moved_m": 40.0)"));
  EXPECT_THAT(here.call({"convert", "dive.tlog", "-o", "nav.csv"}).err, HasSubstr("jumps by 40.0 m in 0.10 s"));
  EXPECT_THAT(here.call({"convert", "dive.tlog", "-o", "nav.tum"}).err, HasSubstr("jumps by 40.0 m in 0.10 s"));
  EXPECT_THAT(here.call({"render", "beams.csv", "--nav", "dive.tlog", "--view", "above", "-o", "map.png"}).err,
              HasSubstr("jumps by 40.0 m in 0.10 s"));
}

// One outlier of a position: the path went there and back.
TEST(Steps, AnOutlierCostsNoBeam) {
  const Workplace here;
  here.write("beams.csv", turning_head());
  here.write("dive.tlog", tlog_of([](std::uint32_t ms, int i) { return stepping_position(ms, i, 150, 151); }));
  const Outcome mapped = map_with(here, "--nav", "dive.tlog");
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.err, HasSubstr("jumps by 40.0 m in 0.10 s at 1700000015.000 s: 1 of 300 samples are dropped"));
  EXPECT_THAT(mapped.out, HasSubstr(R"("no_pose": 1,)")) << "the beam after the last sample";
  EXPECT_LT(extent_m(mapped.out), 10.0);
}

// Home was set during the dive: all depths move by 12.5 m.
TEST(Steps, OfADepthAreLeftOutAndSaid) {
  const Workplace here;
  here.write("beams.csv", turning_head());
  here.write("dive.tlog", tlog_of([](std::uint32_t ms, int i) {
               return mavlink_global_position(ms, -3000 + (i >= 200 ? 12'500 : 0));
             }));
  const Outcome mapped = map_with(here, "--nav", "dive.tlog");
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.err, HasSubstr("depth of GLOBAL_POSITION_INT jumps by 12.5 m in 0.10 s at 1700000020.000 s"));
  EXPECT_LT(corner_m(mapped.out, "map.bounds.max", 2), -2.0);
}

std::string tum_of(const std::function<double(int)>& added_m) {
  std::string poses;
  for (int i = 0; i <= 300; ++i) {
    poses += fmt::format("{:.1f} {} 0 -2 0 0 0 1\n", kStart_s + 0.1 * i, 0.01 * i + added_m(i));
  }
  return poses;
}

// Kills beams on the way of 40 m in 0.1 s, and 20 m beside all others.
TEST(Steps, OfPosesCutThePath) {
  const Workplace here;
  here.write("beams.csv", turning_head());
  here.write("poses.tum", tum_of([](int i) { return i == 50 ? 20.0 : i >= 200 ? 40.0 : 0.0; }));
  const Outcome mapped = map_with(here, "--poses", "poses.tum");
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.err, HasSubstr("poses.tum: its path jumps by 40.0 m in 0.10 s at 1700000020.000 s: no pose is "
                                    "assumed in between\n"));
  EXPECT_THAT(mapped.err, HasSubstr("poses.tum: its path jumps by 20.0 m in 0.10 s at 1700000005.000 s: 1 of 301 poses "
                                    "are dropped\n"));
  EXPECT_THAT(mapped.out, HasSubstr(R"("no_pose": 1,)")) << "the beam in the cut, and only that";
  const Outcome info = here.call({"info", "poses.tum", "--json"});
  EXPECT_THAT(info.out, AllOf(HasSubstr(R"("poses": 301)"), HasSubstr(R"("left_out": 1)")));
  here.write("smooth.tum", tum_of([](int) { return 0.0; }));
  EXPECT_THAT(map_with(here, "--poses", "smooth.tum").err, Not(HasSubstr("jumps")));
}

// A TUM of one pose mapped one beam of a thousand.
TEST(Steps, OnePoseIsAVehicleThatStandsStill) {
  const Workplace here;
  here.write("beams.csv", turning_head());
  here.write("still.tum", "1700000003 5 0 -2 0 0 0 1\n");
  const Outcome mapped = map_with(here, "--poses", "still.tum");
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_EQ(mapped.err, "");
  EXPECT_THAT(mapped.out, HasSubstr(R"("beams": 300)"));
}

/// A vehicle that stands 3 m north of its origin and says so 20 times a second, but for a step of what it says.
class SteppingVehicle {
 public:
  explicit SteppingVehicle(std::uint16_t port) : sender_([this, port] { send(port); }) {}
  SteppingVehicle(const SteppingVehicle&) = delete;
  SteppingVehicle& operator=(const SteppingVehicle&) = delete;
  ~SteppingVehicle() {
    stops_ = true;
    sender_.join();
  }
  void send_an_outlier() { outlier_ = true; }
  void move_the_origin() { is_moved_ = true; }

 private:
  void send(std::uint16_t port) {
    const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to = {};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (std::uint32_t boot_ms = 5000; !stops_; boot_ms += 50) {
      const float aside_m = outlier_.exchange(false) ? 20.0F : is_moved_ ? 40.0F : 0.0F;
      const std::string datagram = mavlink_attitude(boot_ms) + mavlink_position(boot_ms, 3.0F, aside_m, 1.0F);
      ::sendto(socket, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    ::close(socket);
  }

  std::atomic<bool> stops_ = false, outlier_ = false, is_moved_ = false;
  std::thread sender_;
};

// Kills a dive that has no pose after one outlier, and two maps in one without a word.
TEST(Steps, LiveLeavesOutAnOutlierAndSaysThatTheOriginWasMoved) {
  const Head head({}, "40");
  const Workplace here;
  const pid_t child = here.start({"live", head.address(), "--nav", "mavlink:udp://127.0.0.1:0", "-o", "live.bt",
                                  "--range", "4", "--step", "18", "--json"},
                                 {.out_path = here.path("said"), .err_path = here.path("notes")});
  const auto notes_say = [&](const std::string& text) {
    return here.has("notes") && here.read("notes").find(text) != std::string::npos;
  };
  const auto has_said = [&](const std::string& text) {
    return here.has("said") && here.read("said").find(text) != std::string::npos;
  };
  const std::string name = "mavlink:udp://127.0.0.1:";
  ASSERT_TRUE(wait_until([&] { return notes_say(": listening\n"); }));
  const std::string notes = here.read("notes");
  SteppingVehicle vehicle(static_cast<std::uint16_t>(std::stoi(notes.substr(notes.find(name) + name.size()))));
  EXPECT_TRUE(wait_until([&] { return notes_say("position of LOCAL_POSITION_NED"); }));
  vehicle.send_an_outlier();
  EXPECT_TRUE(wait_until([&] { return has_said(R"("outliers": 1, "new_origins": 0)"); })) << here.read("said");
  EXPECT_FALSE(notes_say("jumps"));
  vehicle.move_the_origin();
  EXPECT_TRUE(wait_until([&] { return notes_say("position of LOCAL_POSITION_NED jumps by 40.0 m in "); }));
  EXPECT_TRUE(wait_until([&] { return has_said(R"("new_origins": 1)"); })) << here.read("said");
  EXPECT_TRUE(notes_say("start a new map"));
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_of(child), 0) << here.read("notes");
}

}  // namespace
}  // namespace pingvox::test
