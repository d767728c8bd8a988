// `pingvox live` against `pingvox emulate`, over sockets on the loopback address.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "call.hpp"
#include "live_head.hpp"

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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

void expect_later_signal_ends() {
  const Head head;
  const Workplace here;
  const FullPipe report(here.path("report"));  // for whose reader the last object waits
  const pid_t child = here.start(live(head.address(), {"--quiet", "--json"}), {.out_path = here.path("report")});
  EXPECT_TRUE(wait_until([&] { return here.has("dive.bin") && here.read("dive.bin").size() > 40'000; }));
  int status = 0;
  EXPECT_TRUE(wait_until([&] {
    ::kill(child, SIGINT);
    return ::waitpid(child, &status, WNOHANG) == child;
  }));
  EXPECT_TRUE(WIFSIGNALED(status)) << status;
}

TEST(Live, ALaterSignalEndsAtOnce) {
  expect_later_signal_ends();
}

// A shell starts commands in the background with SIGINT ignored.
TEST(Live, ALaterSignalEndsAtOnceInTheBackgroundOfAScript) {
  const auto before = ::signal(SIGINT, SIG_IGN);
  expect_later_signal_ends();
  ::signal(SIGINT, before);
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
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_EQ(here.call({"compare", "live.ot", "map.ot"}).status, 0) << vote;
  }
}

// Kills a run whose end does not say how far its map can be believed, or says something else than `map`.
TEST(Live, SaysAtItsEndWhatItsSweepsHeard) {
  const Workplace here;
  here.simulate_tank();
  const Outcome live_text = here.call({"live", "replay:tank.csv@max", "-o", "live.ot"});
  const Outcome map_text = here.call({"map", "tank.csv", "-o", "map.ot"});
  for (const char* line : {"  sweeps ", "  places "}) {
    const auto line_of = [&](const std::string& text) {
      const std::size_t at = text.find(line);
      return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
    };
    EXPECT_NE(line_of(live_text.out), "") << live_text.out;
    EXPECT_EQ(line_of(live_text.out), line_of(map_text.out));
  }
  const Outcome json = here.call({"live", "replay:tank.csv@max", "-o", "live.ot", "--json"});
  const std::string last = json.out.substr(json.out.find(R"("done": true)"));
  EXPECT_THAT(last, HasSubstr(R"("coverage": {"coverage": )"));
  EXPECT_THAT(last, HasSubstr(R"("sweeps_per_place": )"));

  // Mostly empty: few of its beams have an echo.
  const Outcome few = here.call({"live", "replay:tank.csv@max", "-o", "live.ot", "--max-range", "1"});
  EXPECT_THAT(few.err, HasSubstr("live.ot: only "));
  EXPECT_THAT(few.err, HasSubstr("of the beams have an echo"));
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
  expect_error(
      here.call({"live", "sonar", "-o", "a.bt"}), 2,
      {"no such device 'sonar'", "ping360:udp://HOST:PORT", "micron:udp://HOST:PORT", "pingviewer2:HOST[:PORT]"});
  for (const char* device : {"pingviewer2:127.0.0.1", "ping360-listen:udp://127.0.0.1:9092"}) {
    expect_error(here.call({"live", device, "-o", "o.bt", "--step", "1.8"}), 2, {"--step"});
    expect_error(here.call({"live", device, "-o", "o.bt", "--gain", "low"}), 2, {"--gain"});
  }
  expect_error(here.call({"live", "pingviewer2:127.0.0.1:x", "-o", "o.bt"}), 2, {"tcp://HOST:PORT"});
  expect_error(here.call({"live", "pingviewer2:127.0.0.1/a b", "-o", "o.bt"}), 2, {"hexadecimal digits"});
  expect_error(here.call({"live", "ping360-listen:/dev/ttyUSB0", "-o", "o.bt"}), 2, {"ping360-listen:udp://HOST:PORT"});
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
  expect_error(here.call({"live", "ros2:/echo", "-o", "a.bt", "--nav", "ros2:/tf:map"}), 2,
               {"'ros2:/tf:map'", "ros2:/tf[:FRAME:FRAME]"});
  expect_error(here.call({"live", "ros2:/echo", "-o", "a.bt", "--ros-distribution", "noetic"}), 2,
               {"--ros-distribution", "humble", "jazzy"});
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
