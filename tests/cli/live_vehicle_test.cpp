// `pingvox live` on a vehicle that tells where it is, and is told what is near.

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "call.hpp"
#include "json_reader.hpp"
#include "live_head.hpp"

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;

/// MAVLink 2, by the bits of its checksum.
std::vector<std::uint8_t> mavlink_frame(std::uint8_t message, std::uint8_t extra, std::uint32_t boot_ms,
                                        const std::array<float, 6>& numbers) {
  std::vector<std::uint8_t> frame = {0xfd, 28, 0, 0, 0, 1, 1, message, 0, 0};
  const auto put = [&](std::uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) frame.push_back(static_cast<std::uint8_t>(word >> shift));
  };
  put(boot_ms);
  for (const float number : numbers) put(std::bit_cast<std::uint32_t>(number));
  unsigned crc = 0xffff;
  for (std::size_t i = 1; i <= frame.size(); ++i) {
    crc ^= i < frame.size() ? frame[i] : extra;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0x8408U : crc >> 1U;
  }
  frame.push_back(static_cast<std::uint8_t>(crc & 0xffU));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return frame;
}

/// A vehicle that heads north 3 m north, 2 m east and 1 m below its origin, and says so 20 times a second.
class Vehicle {
 public:
  /// @param own_port  that it sends from; 0: any
  explicit Vehicle(std::uint16_t port, std::uint16_t own_port = 0)
      : socket_(::socket(AF_INET, SOCK_DGRAM, 0)),
        own_port_(bind_to(own_port)),
        sender_([this, port] { send(port); }) {}
  Vehicle(const Vehicle&) = delete;
  Vehicle& operator=(const Vehicle&) = delete;
  ~Vehicle() {
    stops_ = true;
    sender_.join();
    ::close(socket_);
  }

  std::uint16_t own_port() const { return own_port_; }

 private:
  static sockaddr_in address_of(std::uint16_t port) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }

  std::uint16_t bind_to(std::uint16_t port) const {
    sockaddr_in own = address_of(port);
    socklen_t size = sizeof own;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&own), size), 0);
    EXPECT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size), 0);
    return ntohs(own.sin_port);
  }

  void send(std::uint16_t port) const {
    const sockaddr_in to = address_of(port);
    for (std::uint32_t boot_ms = 5000; !stops_; boot_ms += 50) {
      std::vector<std::uint8_t> datagram = mavlink_frame(30, 39, boot_ms, {});
      const std::vector<std::uint8_t> position = mavlink_frame(32, 185, boot_ms, {3.0F, 2.0F, 1.0F});
      datagram.insert(datagram.end(), position.begin(), position.end());
      ::sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  int socket_;
  std::uint16_t own_port_;
  std::atomic<bool> stops_ = false;
  std::thread sender_;
};

/// Of the autopilot for which a `live` waits, by its file "notes".
std::uint16_t listening_port(const Workplace& here) {
  const std::string name = "mavlink:udp://127.0.0.1:";
  const auto says = [&](const std::string& text) {
    return here.has("notes") && here.read("notes").find(text) != std::string::npos;
  };
  if (!wait_until([&] { return says(": listening\n") && says(name); })) {
    ADD_FAILURE() << here.read("notes");
    return 0;
  }
  const std::string notes = here.read("notes");
  return static_cast<std::uint16_t>(std::stoi(notes.substr(notes.find(name) + name.size())));
}

// Kills frames that are not converted, clocks that differ, and recordings that `map` cannot align, as those without a
// date.
TEST(Live, MapsAroundAVehicleThatSaysWhereItIs) {
  const Head head({}, "40");
  const Workplace here;
  const pid_t child =
      here.start({"live", head.address(), "--nav", "mavlink:udp://127.0.0.1:0", "-o", "live.bt", "--record", "dive.bin",
                  "--range", "4", "--step", "18", "--resolution", "0.1", "--beams", "160", "--json"},
                 {.out_path = here.path("said"), .err_path = here.path("notes")});
  const std::uint16_t port = listening_port(here);
  {
    const Vehicle vehicle(port);
    EXPECT_EQ(status_of(child), 0) << here.read("notes");
  }
  EXPECT_THAT(here.read("notes"), HasSubstr("attitude of ATTITUDE, position of LOCAL_POSITION_NED"));
  EXPECT_THAT(here.read("said"), HasSubstr(R"("attitude": "ATTITUDE", "position": "LOCAL_POSITION_NED")"));

  const Outcome mapped = here.call({"map", "dive.bin", "--nav", "dive.tlog", "-o", "map.bt", "--resolution", "0.1"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("from ATTITUDE and LOCAL_POSITION_NED"));
  EXPECT_THAT(mapped.out, HasSubstr("+0.000 s: both have dates"));
  here.write("still.tum",
             "0 2 3 -1 0 0 0.70710678118654752 0.70710678118654752\n"
             "1e10 2 3 -1 0 0 0.70710678118654752 0.70710678118654752\n");
  ASSERT_EQ(here.call({"map", "dive.bin", "--poses", "still.tum", "-o", "still.bt", "--resolution", "0.1"}).status, 0);
  // Beams of the first second have no pose yet.
  for (const char* map : {"live.bt", "map.bt"}) {
    const Outcome compared = here.call({"compare", map, "still.bt", "--json"});
    auto json = flat_json(compared.out);
    ASSERT_TRUE(json) << compared.out;
    const double cells = std::stod((*json)["cells"]);
    EXPECT_LT(std::stod((*json)["different"]), 0.05 * cells) << map << compared.out;
    EXPECT_LT(std::stod((*json)["only_a"]), 0.01 * cells) << map << compared.out;
    EXPECT_GT(std::stod((*json)["same"]), 0.3 * cells) << map << compared.out;
  }
}

// Kills two maps in one without a word: positions of the second start are relative to where the vehicle was then.
TEST(Live, SaysThatAnAutopilotRestarted) {
  const Head head({}, "40");
  const Workplace here;
  const pid_t child = here.start({"live", head.address(), "--nav", "mavlink:udp://127.0.0.1:0", "-o", "live.bt",
                                  "--range", "4", "--step", "18", "--json"},
                                 {.out_path = here.path("said"), .err_path = here.path("notes")});
  const std::uint16_t port = listening_port(here);
  const auto notes_say = [&](const char* text) { return here.read("notes").find(text) != std::string::npos; };
  std::uint16_t own_port = 0;
  {
    const Vehicle first(port);
    own_port = first.own_port();
    EXPECT_TRUE(wait_until([&] { return notes_say("position of LOCAL_POSITION_NED"); }));
    // The clock of the second one begins further back than messages overtake each other.
    std::this_thread::sleep_for(std::chrono::seconds(2));
  }
  EXPECT_FALSE(notes_say("restarted"));
  {
    const Vehicle second(port, own_port);
    EXPECT_TRUE(wait_until([&] { return notes_say("the sender of LOCAL_POSITION_NED restarted"); }));
  }
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_of(child), 0) << here.read("notes");
}

// Emulators that are started one after the other have to put the vehicle at the same place: else walls are doubled.
TEST(Live, MapsAlongTheWayThatAnEmulatedDvlTells) {
  const Head head({"--trajectory", "loop", "--speed", "1"}, "100");
  const Workplace here;
  std::filesystem::create_directory(here.path("dives"));
  const pid_t dvl = here.start({"emulate", "a50", "--listen", "tcp://127.0.0.1:0", "--trajectory", "loop", "--speed",
                                "1", "--rate", "20", "--damaged", "0.02"},
                               {.out_path = here.path("address")});
  EXPECT_TRUE(wait_until([&] { return here.has("address") && here.read("address").find('\n') != std::string::npos; }));
  const std::string address = here.read("address");
  const Outcome live = here.call({"live", head.address(), "--nav", "a50:" + address.substr(0, address.find('\n')),
                                  "--nav", "mavlink:udp://127.0.0.1:0", "-o", "live.bt", "--record", "dives", "--range",
                                  "6", "--step", "9", "--resolution", "0.1", "--beams", "400", "--json"});
  ::kill(dvl, SIGTERM);
  EXPECT_EQ(status_of(dvl), 0);
  ASSERT_EQ(live.status, 0) << live.err;
  EXPECT_THAT(live.err, HasSubstr("attitude of A50, position of A50")) << "the autopilot is silent";
  EXPECT_THAT(live.err, HasSubstr(": connected"));
  EXPECT_THAT(live.out, MatchesRegex("(\\{[^\n]*\\}\n)+")) << "an object a line";
  EXPECT_THAT(live.out, HasSubstr(R"("connected": true, "connections": 1, "messages":)"));
  std::string sonar, nav;
  for (const auto& entry : std::filesystem::directory_iterator(here.path("dives"))) {
    if (entry.path().extension() == ".jsonl") nav = entry.path().string();
    if (entry.path().extension() == ".bin") sonar = entry.path().string();
  }
  const Outcome mapped = here.call({"map", sonar, "--nav", nav, "-o", "map.bt", "--resolution", "0.1"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  const Outcome compared = here.call({"compare", "live.bt", "map.bt", "--json"});
  auto json = flat_json(compared.out);
  ASSERT_TRUE(json) << compared.out;
  EXPECT_GT(std::stod((*json)["same"]), 0.5 * std::stod((*json)["cells"])) << compared.out;
}

/// An autopilot on a free port of this host.
class Autopilot {
 public:
  Autopilot() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_in own = {};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    const bool is_bound = ::bind(socket_, reinterpret_cast<const sockaddr*>(&own), size) == 0 &&
                          ::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size) == 0;
    if (!is_bound) ADD_FAILURE() << "no free port";
    address_ = "udp://127.0.0.1:" + std::to_string(ntohs(own.sin_port));
  }
  Autopilot(const Autopilot&) = delete;
  Autopilot& operator=(const Autopilot&) = delete;
  ~Autopilot() { ::close(socket_); }

  const std::string& address() const { return address_; }

  /// The next frame that has come. @return its size; at most 0: there is none
  ssize_t take(std::span<std::uint8_t> frame) const { return ::recv(socket_, frame.data(), frame.size(), 0); }
  bool is_told() const {
    std::array<std::uint8_t, 300> frame = {};
    return take(frame) > 0;
  }
  /// Waits until nothing comes for a second.
  bool is_told_no_more() const {
    return wait_until([&] {
      while (is_told()) continue;
      std::this_thread::sleep_for(std::chrono::seconds(1));
      return !is_told();
    });
  }

 private:
  int socket_;
  std::string address_;
};

TEST(Live, TellsTheAutopilotWhatIsNear) {
  const Head head({}, "100");
  const Workplace here;
  const Autopilot autopilot;
  const Outcome outcome = here.call(live(head.address(), {"--beams", "100", "--obstacles", autopilot.address()}));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  std::array<std::uint8_t, 300> frame = {};
  int frames = 0;
  while (autopilot.take(frame) == 179) ++frames;
  EXPECT_GE(frames, 3);
  EXPECT_EQ(frame[7] | frame[8] << 8, 330);
  int near = 0;
  for (std::size_t i = 18; i < 162; i += 2) near += (frame[i] | frame[i + 1] << 8) <= 400 ? 1 : 0;
  EXPECT_GT(near, 18) << "of 72 sectors";
}

// Kills obstacles around where the vehicle was long ago.
TEST(Live, TellsNoObstaclesWhereTheVehicleFellSilent) {
  const Head head({}, "40");
  const Workplace here;
  const Autopilot autopilot;
  const pid_t child = here.start({"live", head.address(), "--nav", "mavlink:udp://127.0.0.1:0", "-o", "live.bt",
                                  "--range", "4", "--step", "18", "--vote", "beam", "--obstacles", autopilot.address()},
                                 {.err_path = here.path("notes")});
  const std::uint16_t port = listening_port(here);
  {
    const Vehicle vehicle(port);
    EXPECT_TRUE(wait_until([&] { return autopilot.is_told(); }));
  }
  EXPECT_TRUE(autopilot.is_told_no_more());
  EXPECT_TRUE(wait_until([&] { return here.read("notes").find("no pose for 5 s") != std::string::npos; }));
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_of(child), 0) << here.read("notes");
}

// Kills sectors that are said to be free by a sonar that is off.
TEST(Live, TellsNoObstaclesWhenTheHeadFellSilent) {
  const Workplace here;
  const Autopilot autopilot;
  pid_t child = -1;
  {
    const Head head({}, "100");
    child = here.start(
        {"live", head.address(), "-o", "live.bt", "--range", "4", "--step", "18", "--obstacles", autopilot.address()});
    EXPECT_TRUE(wait_until([&] { return autopilot.is_told(); }));
  }
  EXPECT_TRUE(autopilot.is_told_no_more());
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_of(child), 0);
}

TEST(Live, LeavesBeamsOutWhoseVehicleSaysNothing) {
  const Head head;
  const Workplace here;
  const std::string silent = "mavlink:udp://127.0.0.1:0";
  const Outcome outcome =
      here.call(live(head.address(), {"--nav", silent, "--nav", silent, "--beams", "50", "--json"}));
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(R"("mapped": 0)"));
  EXPECT_THAT(outcome.out, HasSubstr(R"("messages": 0, "damaged": 0, "recording_failed": false)"));
  EXPECT_THAT(outcome.err, HasSubstr("live.bt: not written: no beam was mapped"));
  EXPECT_EQ(here.files(), (std::vector<std::string>{"dive-2.tlog", "dive.bin", "dive.tlog"}));
}

// Kills a status that counts them with the turn of the head only, when all of it is lost.
TEST(Live, CountsBeamsWithoutAPoseAtOnce) {
  const Head head({}, "50");
  const Workplace here;
  const Outcome outcome = here.call({"live", head.address(), "--nav", "mavlink:udp://127.0.0.1:0", "-o", "live.bt",
                                     "--range", "4", "--step", "0.9", "--beams", "200", "--json"});
  std::istringstream objects(outcome.out);
  bool is_counted = false;
  for (std::string object; std::getline(objects, object);) {
    const bool is_last = object.find(R"("done": true)") != std::string::npos;
    const bool counts = object.find(R"("without_pose": 0)") == std::string::npos &&
                        object.find(R"("not_mapped": 0)") == std::string::npos;
    is_counted = is_counted || (counts && !is_last);
  }
  EXPECT_TRUE(is_counted) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr(R"("without_pose": 200)")) << "each of them once";
  EXPECT_THAT(outcome.out, HasSubstr(R"("not_mapped": 200)"));
}

// Recordings that a failed call left behind were in the way of the next one.
TEST(Live, LeavesNoRecordingsOfARunThatDidNotBegin) {
  const Workplace here;
  const std::string head = "ping360:udp://127.0.0.1:1";
  {
    const Autopilot other;
    expect_error(here.call(live(head, {"--nav", "mavlink:" + other.address()})), 1, {other.address(), "in use"});
  }
  EXPECT_THAT(here.files(), ElementsAre());

  here.write("dive.tlog", "of an earlier dive");
  expect_error(here.call(live(head, {"--nav", "mavlink:udp://127.0.0.1:0"})), 1, {"dive.tlog", "exists"});
  EXPECT_THAT(here.files(), ElementsAre("dive.tlog"));
  EXPECT_EQ(here.read("dive.tlog"), "of an earlier dive");

  // Less than the header of a recording, and more than the message.
  expect_error(here.call(live(head, {}), {.file_bytes = 100}), 1, {"dive.bin", "too large"});
  EXPECT_THAT(here.files(), ElementsAre("dive.tlog"));
}

}  // namespace
}  // namespace pingvox::test
