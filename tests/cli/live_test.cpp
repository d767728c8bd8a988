// `pingvox live` against `pingvox emulate`, over sockets on the loopback address.

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;

/// Waits until something holds, at most a minute.
template <class Holds>
bool wait_until(const Holds& holds) {
  for (int i = 0; i < 6000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// An emulated head, which runs as long as it is in scope.
class Head {
 public:
  explicit Head(std::vector<std::string> options = {}, const char* pings_per_s = "1000",
                const std::string& device = "ping360", const char* line = "udp://127.0.0.1:0") {
    options.insert(options.begin(), {"emulate", device, "--listen", line, "--rate", pings_per_s});
    child_ = place_.start(options, {.out_path = place_.path("address")});
    const bool listens =
        wait_until([&] { return place_.has("address") && place_.read("address").find('\n') != std::string::npos; });
    if (!listens) ADD_FAILURE() << "the emulator says no address";
    address_ = place_.read("address");
    address_ = device + ":" + address_.substr(0, address_.find('\n'));
  }
  Head(const Head&) = delete;
  Head& operator=(const Head&) = delete;
  ~Head() {
    ::kill(child_, SIGKILL);
    status_of(child_);
  }
  const std::string& address() const { return address_; }

 private:
  Workplace place_;
  pid_t child_ = -1;
  std::string address_;
};

/// A `live` with a small and quick picture: 20 beams a turn.
std::vector<std::string> live(const std::string& device, std::vector<std::string> options) {
  options.insert(options.begin(), {"live", device, "-o", "live.bt", "--record", "dive.bin", "--range", "4", "--step",
                                   "18", "--timeout", "0.2", "--resolution", "0.1"});
  return options;
}

void expect_map_of_record(const Workplace& here) {
  const Outcome mapped = here.call({"map", "dive.bin", "-o", "map.bt", "--resolution", "0.1", "--quiet"});
  EXPECT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_EQ(here.read("live.bt"), here.read("map.bt"));
  EXPECT_GT(here.read("live.bt").size(), 200U);
}

TEST(Live, MapsTheSameAsItsRecordToTheBit) {
  const Head head({"--lost", "0.00005", "--doubled", "0.00005", "--damaged", "0.00005"});
  const Workplace here;
  const Outcome outcome = here.call(live(head.address(), {"--beams", "50", "--json"}));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(R"("done": true)"));
  EXPECT_THAT(outcome.out, HasSubstr(R"("not_mapped": 0)"));
  EXPECT_THAT(outcome.err, HasSubstr("recording to dive.bin\n"));
  EXPECT_THAT(outcome.err, HasSubstr("connected"));
  expect_map_of_record(here);
}

// A head that sends two lines for a request, restarts, and has a line with faults.
TEST(Live, MapsAMicronOverATerminalTheSameAsItsRecordToTheBit) {
  const Head head(
      {"--lines", "2", "--stall-every", "80", "--stall", "0.5", "--lost", "0.00002", "--damaged", "0.00002"}, "1000",
      "micron", "pty");
  const Workplace here;
  const Outcome outcome =
      here.call({"live", head.address(), "-o", "live.bt", "--record", "dive.csv", "--range", "4", "--step", "13.5",
                 "--sector", "-175,170", "--timeout", "0.2", "--resolution", "0.1", "--beams", "120", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(R"("not_mapped": 0)"));
  EXPECT_THAT(outcome.err, HasSubstr("connected"));
  const Outcome mapped = here.call({"map", "dive.csv", "-o", "map.bt", "--resolution", "0.1"});
  EXPECT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("3 degrees wide, 35 high"));
  EXPECT_EQ(here.read("live.bt"), here.read("map.bt"));
  EXPECT_GT(here.read("live.bt").size(), 200U);
}

TEST(Live, FinishesRecordAndMapOnASignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Head head;
    const Workplace here;
    const pid_t child = here.start(live(head.address(), {"--quiet"}));
    EXPECT_TRUE(wait_until([&] { return here.has("dive.bin") && here.read("dive.bin").size() > 40'000; }));
    ::kill(child, signal);
    EXPECT_EQ(status_of(child), 0);
    EXPECT_THAT(here.files(), ElementsAre("dive.bin", "live.bt"));
    expect_map_of_record(here);
  }
}

// GNU timeout signals the process and then its group.
TEST(Live, ASecondSignalRightAfterTheFirstSaysTheSame) {
  const Head head;
  for (int i = 0; i < 5; ++i) {
    const Workplace here;
    const pid_t child = here.start(live(head.address(), {"--quiet"}));
    EXPECT_TRUE(wait_until([&] { return here.has("dive.bin") && here.read("dive.bin").size() > 40'000; }));
    ::kill(child, SIGINT);
    ::kill(child, SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(child, SIGINT);
    EXPECT_EQ(status_of(child), 0);
    EXPECT_TRUE(here.has("live.bt"));
  }
}

TEST(Live, ALaterSignalEndsAtOnce) {
  const Head head;
  const Workplace here;
  ASSERT_EQ(::mkfifo(here.path("live.bt").c_str(), 0600), 0);  // that nobody reads: the map is never written
  const pid_t child = here.start(live(head.address(), {"--quiet"}));
  EXPECT_TRUE(wait_until([&] { return here.has("dive.bin") && here.read("dive.bin").size() > 40'000; }));
  int status = 0;
  EXPECT_TRUE(wait_until([&] {
    ::kill(child, SIGINT);
    return ::waitpid(child, &status, WNOHANG) == child;
  }));
  EXPECT_TRUE(WIFSIGNALED(status)) << status;
}

// The first moment is before the record begins or early in it, the last one after many maps were written.
TEST(Live, ALiveRunThatIsKilledLeavesARecordAndAWholeMap) {
  const Head head;
  for (const std::size_t bytes : {0U, 5'000U, 40'000U, 80'000U, 160'000U}) {
    SCOPED_TRACE(bytes);
    const Workplace here;
    const pid_t child = here.start(live(head.address(), {"--quiet", "--write-every", "0.1"}));
    EXPECT_TRUE(wait_until([&] { return here.has("dive.bin") && here.read("dive.bin").size() >= bytes; }));
    const bool waits_for_map = bytes >= 40'000;
    EXPECT_TRUE(!waits_for_map || wait_until([&] { return here.has("live.bt"); }));
    ::kill(child, SIGKILL);
    EXPECT_EQ(status_of(child), 128 + SIGKILL);
    if (bytes > 0) {
      const Outcome record = here.call({"info", "dive.bin", "--json"});
      EXPECT_EQ(record.status, 0) << record.err;
      EXPECT_THAT(record.out, HasSubstr(R"("format": "pingviewer")"));
      EXPECT_EQ(here.call({"info", "dive.bin", "--strict"}).status, 0) << "whole records only";
    }
    if (here.has("live.bt")) {
      EXPECT_EQ(here.call({"info", "live.bt"}).status, 0);
    }
  }
}

TEST(Live, GoesOnMappingWhenTheRecordMeetsAFullDisk) {
  const Head head;
  const Workplace here;
  const Outcome outcome = here.call(live(head.address(), {"--beams", "40"}), {.file_bytes = 30'000});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("dive.bin: File too large: the recording ended; mapping goes on"));
  EXPECT_THAT(outcome.out, HasSubstr("40 beams"));
  EXPECT_EQ(here.call({"info", "dive.bin", "--strict"}).status, 0) << "whole records only";
  EXPECT_EQ(here.call({"info", "live.bt"}).status, 0);
}

TEST(Live, ComesBackToAHeadThatWasSilent) {
  const Head head({"--stall-every", "10", "--stall", "1"});
  const Workplace here;
  const Outcome outcome = here.call(live(head.address(), {"--beams", "25", "--json"}));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("no answer"));
  expect_map_of_record(here);
}

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
  explicit Vehicle(std::uint16_t port) : sender_([this, port] { send(port); }) {}
  Vehicle(const Vehicle&) = delete;
  Vehicle& operator=(const Vehicle&) = delete;
  ~Vehicle() {
    stops_ = true;
    sender_.join();
  }

 private:
  void send(std::uint16_t port) const {
    const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to = {};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (std::uint32_t boot_ms = 5000; !stops_; boot_ms += 50) {
      std::vector<std::uint8_t> datagram = mavlink_frame(30, 39, boot_ms, {});
      const std::vector<std::uint8_t> position = mavlink_frame(32, 185, boot_ms, {3.0F, 2.0F, 1.0F});
      datagram.insert(datagram.end(), position.begin(), position.end());
      ::sendto(socket, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    ::close(socket);
  }

  std::atomic<bool> stops_ = false;
  std::thread sender_;
};

// Kills frames that are not converted, clocks that differ, and recordings that `map` cannot align, as those without a
// date.
TEST(Live, MapsAroundAVehicleThatSaysWhereItIs) {
  const Head head({}, "40");
  const Workplace here;
  const pid_t child =
      here.start({"live", head.address(), "--nav", "mavlink:udp://127.0.0.1:0", "-o", "live.bt", "--record", "dive.bin",
                  "--range", "4", "--step", "18", "--resolution", "0.1", "--beams", "160", "--json"},
                 {.out_path = here.path("said"), .err_path = here.path("notes")});
  const std::string name = "mavlink:udp://127.0.0.1:";
  EXPECT_TRUE(
      wait_until([&] { return here.has("notes") && here.read("notes").find(": listening\n") != std::string::npos; }));
  const std::string notes = here.read("notes");
  const std::size_t at = notes.find(name);
  ASSERT_NE(at, std::string::npos) << notes;
  {
    const Vehicle vehicle(static_cast<std::uint16_t>(std::stoi(notes.substr(at + name.size()))));
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

/// A UDP socket on a free port of this host; -1: there is none.
/// @param address  of it
int bound_socket(std::string& address) {
  const int bound = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
  sockaddr_in own = {};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  if (::bind(bound, reinterpret_cast<const sockaddr*>(&own), size) != 0 ||
      ::getsockname(bound, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
    return -1;
  }
  address = "udp://127.0.0.1:" + std::to_string(ntohs(own.sin_port));
  return bound;
}

TEST(Live, TellsTheAutopilotWhatIsNear) {
  const Head head({}, "100");
  const Workplace here;
  std::string address;
  const int autopilot = bound_socket(address);
  ASSERT_GE(autopilot, 0);
  const Outcome outcome = here.call(live(head.address(), {"--beams", "100", "--obstacles", address}));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  std::array<std::uint8_t, 300> frame = {};
  int frames = 0;
  while (::recv(autopilot, frame.data(), frame.size(), 0) == 179) ++frames;
  ::close(autopilot);
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
  std::string address;
  const int autopilot = bound_socket(address);
  ASSERT_GE(autopilot, 0);
  const pid_t child = here.start({"live", head.address(), "--nav", "mavlink:udp://127.0.0.1:0", "-o", "live.bt",
                                  "--range", "4", "--step", "18", "--vote", "beam", "--obstacles", address},
                                 {.err_path = here.path("notes")});
  const std::string name = "mavlink:udp://127.0.0.1:";
  EXPECT_TRUE(
      wait_until([&] { return here.has("notes") && here.read("notes").find(": listening\n") != std::string::npos; }));
  const std::string notes = here.read("notes");
  const std::size_t at = notes.find(name);
  ASSERT_NE(at, std::string::npos) << notes;
  std::array<std::uint8_t, 300> frame = {};
  const auto is_told = [&] { return ::recv(autopilot, frame.data(), frame.size(), 0) > 0; };
  {
    const Vehicle vehicle(static_cast<std::uint16_t>(std::stoi(notes.substr(at + name.size()))));
    EXPECT_TRUE(wait_until(is_told));
  }
  EXPECT_TRUE(wait_until([&] {
    while (is_told()) continue;
    std::this_thread::sleep_for(std::chrono::seconds(1));
    return !is_told();
  }));
  EXPECT_TRUE(wait_until([&] { return here.read("notes").find("no pose for 5 s") != std::string::npos; }));
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_of(child), 0) << here.read("notes");
  ::close(autopilot);
}

// Kills sectors that are said to be free by a sonar that is off.
TEST(Live, TellsNoObstaclesWhenTheHeadFellSilent) {
  const Workplace here;
  std::string address;
  const int autopilot = bound_socket(address);
  ASSERT_GE(autopilot, 0);
  std::array<std::uint8_t, 300> frame = {};
  const auto is_told = [&] { return ::recv(autopilot, frame.data(), frame.size(), 0) > 0; };
  pid_t child = -1;
  {
    const Head head({}, "100");
    child =
        here.start({"live", head.address(), "-o", "live.bt", "--range", "4", "--step", "18", "--obstacles", address});
    EXPECT_TRUE(wait_until(is_told));
  }
  EXPECT_TRUE(wait_until([&] {
    while (is_told()) continue;
    std::this_thread::sleep_for(std::chrono::seconds(1));
    return !is_told();
  }));
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_of(child), 0);
  ::close(autopilot);
}

// A terminal that was stopped with Ctrl-S stopped the head and the recording, too.
TEST(Live, GoesOnWhereItsStatusIsNotRead) {
  const Head head({}, "100");
  const Workplace here;
  ASSERT_EQ(::mkfifo(here.path("status").c_str(), 0600), 0);
  const int status = ::open(here.path("status").c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(status, 0);
  const std::string filler(4096, ' ');
  while (::write(status, filler.data(), filler.size()) > 0) continue;
  const pid_t child = here.start(live(head.address(), {"--json"}), {.out_path = here.path("status")});
  const auto recorded = [&] { return here.has("dive.bin") ? here.read("dive.bin").size() : 0; };
  EXPECT_TRUE(wait_until([&] { return recorded() > 100'000; }));
  // Beyond the second at which the status is printed.
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  const std::size_t before = recorded();
  EXPECT_TRUE(wait_until([&] { return recorded() > before + 10'000; }));
  ::kill(child, SIGTERM);
  std::string said(1 << 20, ' ');
  EXPECT_TRUE(wait_until([&] {
    const ssize_t got = ::read(status, said.data(), said.size());
    return got > 0 && std::string_view(said).substr(0, static_cast<std::size_t>(got)).find("true") != std::string::npos;
  }));
  EXPECT_EQ(status_of(child), 0);
  ::close(status);
}

// A replay of a pipe in which nothing comes could not be ended by Ctrl-C.
TEST(Live, EndsAtASecondSignalWhereverItWaits) {
  const Workplace here;
  ASSERT_EQ(::mkfifo(here.path("log").c_str(), 0600), 0);
  const pid_t child = here.start({"live", "replay:log", "-o", "live.bt", "--quiet"});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  int status = 0;
  bool has_ended = false;
  for (int i = 0; i < 100 && !has_ended; ++i) {
    ::kill(child, SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    has_ended = ::waitpid(child, &status, WNOHANG) == child;
  }
  EXPECT_TRUE(has_ended && WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
  if (!has_ended) {
    ::kill(child, SIGKILL);
    status_of(child);
  }
}

TEST(Live, MakesTheFolderOfItsRecordings) {
  const Head head;
  const Workplace here;
  for (int run = 1; run <= 2; ++run) {
    const Outcome outcome = here.call({"live", head.address(), "-o", "live.bt", "--record", "dives", "--range", "1",
                                       "--step", "18", "--beams", "50", "--quiet"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(here.path("dives")), {}), run);
  }
}

// Kills a report that is left out where the map could not be written.
TEST(Live, ReportsWhatItDidThoughTheMapCannotBeWritten) {
  const Head head;
  const Workplace here;
  const Outcome outcome =
      here.call({"live", head.address(), "-o", "live.bt", "--range", "1", "--step", "18", "--beams", "50", "--json"},
                {.file_bytes = 100});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("live.bt"));
  EXPECT_THAT(outcome.out, HasSubstr(R"("done": true)"));
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

// Recordings that a failed call left behind were in the way of the next one.
TEST(Live, LeavesNoRecordingsOfARunThatDidNotBegin) {
  const Workplace here;
  std::string address;
  const int other = bound_socket(address);
  ASSERT_GE(other, 0);
  const std::string taken = "mavlink:" + address;
  const std::string head = "ping360:udp://127.0.0.1:1";
  expect_error(here.call(live(head, {"--nav", taken})), 1, {taken.substr(8), "in use"});
  ::close(other);
  EXPECT_THAT(here.files(), ElementsAre());

  here.write("dive.tlog", "of an earlier dive");
  expect_error(here.call(live(head, {"--nav", "mavlink:udp://127.0.0.1:0"})), 1, {"dive.tlog", "exists"});
  EXPECT_THAT(here.files(), ElementsAre("dive.tlog"));
  EXPECT_EQ(here.read("dive.tlog"), "of an earlier dive");

  // Less than the header of a recording, and more than the message.
  expect_error(here.call(live(head, {}), {.file_bytes = 100}), 1, {"dive.bin", "too large"});
  EXPECT_THAT(here.files(), ElementsAre("dive.tlog"));
}

// An empty map replaced that of an earlier dive.
TEST(Live, WithoutABeamTheOldMapStays) {
  const Workplace here;
  here.write("live.bt", "of an earlier dive");
  const pid_t child =
      here.start({"live", "ping360:udp://127.0.0.1:1", "-o", "live.bt", "--write-every", "0.1", "--progress", "always"},
                 {.out_path = here.path("said"), .err_path = here.path("notes")});
  // The status is shown once a second, by the loop that writes maps: by the second one many would be written.
  const auto has_two = [&] {
    const std::string notes = here.has("notes") ? here.read("notes") : "", status = " 0 beams,";
    return notes.find(status) != notes.rfind(status);
  };
  EXPECT_TRUE(wait_until(has_two));
  EXPECT_EQ(here.read("live.bt"), "of an earlier dive");
  ::kill(child, SIGINT);
  EXPECT_EQ(status_of(child), 1);
  EXPECT_THAT(here.read("said"), HasSubstr("no map\n"));
  EXPECT_THAT(here.read("notes"), HasSubstr("live.bt: not written: no beam was mapped"));
  EXPECT_EQ(here.read("live.bt"), "of an earlier dive");
}

TEST(Live, AReplayMapsAsMapDoes) {
  const Workplace here;
  here.simulate_tank();
  for (const char* vote : {"sweep", "beam"}) {
    const Outcome outcome = here.call({"live", "replay:tank.csv@max", "-o", "live.ot", "--vote", vote, "--quiet"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(here.call({"map", "tank.csv", "-o", "map.ot", "--vote", vote, "--quiet"}).status, 0);
    EXPECT_EQ(here.call({"compare", "live.ot", "map.ot"}).status, 0) << vote;
  }
}

// A head takes 20 s for a turn: an obstacle that is heard at its beginning has to be told before its end.
TEST(Live, MapsBeamsBeforeTheirSweepEndsWithAVotePerBeam) {
  for (const std::string vote : {"sweep", "beam"}) {
    const Head head({"--pings", "250"});  // of 400 a turn
    const Workplace here;
    const pid_t child = here.start({"live", head.address(), "-o", "live.bt", "--range", "4", "--resolution", "0.1",
                                    "--vote", vote, "--quiet", "--json"},
                                   {.out_path = here.path("said")});
    const auto said = [&](const std::string& what) { return here.read("said").find(what) != std::string::npos; };
    EXPECT_TRUE(wait_until([&] { return here.has("said") && said(R"("beams": 250,)"); }));
    EXPECT_EQ(said(R"("beams": 250, "mapped": 0,)"), vote == "sweep");
    ::kill(child, SIGKILL);
    status_of(child);
  }
}

TEST(Live, RefusesDevicesThatItDoesNotKnowAndFilesThatExist) {
  const Workplace here;
  expect_error(here.call({"live", "sonar", "-o", "a.bt"}), 2,
               {"no such device 'sonar'", "ping360:udp://HOST:PORT", "micron:udp://HOST:PORT"});
  EXPECT_THAT(here.call({"live", "--help"}).out, HasSubstr("micron:udp://HOST:PORT"));
  expect_error(here.call({"live", "replay:a.bin@0", "-o", "a.bt"}), 2, {"above 0"});
  // What can never be reached is not tried again and again.
  expect_error(here.call({"live", "ping360:udp://host", "-o", "a.bt"}), 2, {"DEVICE", "udp://HOST:PORT"});
  expect_error(here.call({"live", "micron:/dev/ttyUSB0@1234", "-o", "a.bt"}), 2, {"baud rate"});
  expect_error(here.call({"live", "micron:/dev/ttyUSB0@", "-o", "a.bt"}), 2, {"baud rate"});
  expect_error(here.call({"live", "ping360:/dev/ttyUSB0@99999999999", "-o", "a.bt"}), 2, {"baud rate"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--obstacles", "udp://a"}), 2,
               {"--obstacles", "udp://HOST:PORT"});
  expect_error(here.call({"live", "replay:a.bin", "-o", "a.bt", "--range", "5"}), 2, {"--range", "a replay", "a head"});
  expect_error(here.call({"live", "replay:a.bin", "-o", "a.bt", "--record", "b.bin"}), 2, {"--record"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "-"}), 2, {"-o -"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--sector", "60,-60"}), 2, {"--sector"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--step", "1"}), 2, {"multiple of 0.9"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--nav", "udp://:14550"}), 2,
               {"--nav", "mavlink:udp://:PORT"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--nav", "mavlink:udp://nowhere"}), 2,
               {"udp://HOST:PORT"});
  expect_error(here.call({"live", "replay:a.bin", "-o", "a.bt", "--nav", "mavlink:udp://:14550"}), 2, {"--nav"});
  for (const char* head : {"ping360:udp://127.0.0.1:9", "micron:udp://127.0.0.1:9"}) {
    expect_error(here.call({"live", head, "-o", "a.bt", "--sector", "-1,1", "--step", "5.4"}), 2,
                 {"--step: is 5.4 degrees, more than --sector"});
  }
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--nav", "mavlink:udp://:14550",
                          "--record", "a.tlog"}),
               2, {"--record: .tlog is for --nav"});
  here.write("dive.bin", "here already");
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--record", "dive.bin"}), 1,
               {"dive.bin", "exists"});
  EXPECT_EQ(here.read("dive.bin"), "here already");
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--nav", "a50:udp://dvl"}), 2,
               {"a50:tcp://HOST[:PORT]"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--obstacles", "tcp://a:1"}), 2,
               {"--obstacles", "udp://HOST:PORT"});
  expect_error(here.call({"live", "micron:udp://127.0.0.1:9", "-o", "a.bt", "--step", "0.1"}), 2,
               {"--step", "multiple of 0.05625"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--range", "200"}), 2, {"range_m", "100"});
  expect_error(here.call({"emulate", "echoscope"}), 2, {"no such device 'echoscope'"});
  expect_error(here.call({"emulate", "mavlink", "--listen", "udp://127.0.0.1:9"}), 2, {"--listen", "DEVICE mavlink"});
  expect_error(here.call({"emulate", "a50", "--to", "udp://127.0.0.1:9"}), 2, {"--to"});
  expect_error(here.call({"emulate", "a50", "--pings", "1"}), 2, {"--pings", "DEVICE a50"});
  expect_error(here.call({"emulate", "ping360", "--speed", "1"}), 2, {"--speed", "--trajectory"});
  expect_error(here.call({"emulate", "a50", "--listen", "pty"}), 2, {"tcp://HOST:PORT"});
  expect_error(here.call({"emulate", "mavlink", "--rate", "2000"}), 2, {"reports_per_s"});
}

}  // namespace
}  // namespace pingvox::test
