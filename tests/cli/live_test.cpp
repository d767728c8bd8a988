// `pingvox live` against `pingvox emulate`, over sockets on the loopback address.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "call.hpp"

namespace pingvox::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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
  explicit Head(std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"emulate", "ping360", "--listen", "udp://127.0.0.1:0", "--rate", "1000"});
    child_ = place_.start(options, {.out_path = place_.path("address")});
    const bool listens =
        wait_until([&] { return place_.has("address") && place_.read("address").find('\n') != std::string::npos; });
    if (!listens) ADD_FAILURE() << "the emulator says no address";
    address_ = place_.read("address");
    address_ = "ping360:" + address_.substr(0, address_.find('\n'));
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
  EXPECT_THAT(outcome.err, HasSubstr("connected"));
  expect_map_of_record(here);
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

TEST(Live, ALiveRunThatIsKilledLeavesARecordAndAWholeMap) {
  const Head head;
  const Workplace here;
  const pid_t child = here.start(live(head.address(), {"--quiet", "--write-every", "0.1"}));
  EXPECT_TRUE(
      wait_until([&] { return here.has("live.bt") && here.has("dive.bin") && here.read("dive.bin").size() > 40'000; }));
  ::kill(child, SIGKILL);
  EXPECT_EQ(status_of(child), 128 + SIGKILL);
  const Outcome record = here.call({"info", "dive.bin", "--json"});
  EXPECT_EQ(record.status, 0) << record.err;
  EXPECT_THAT(record.out, HasSubstr(R"("format": "pingviewer")"));
  EXPECT_EQ(here.call({"info", "live.bt"}).status, 0);
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

TEST(Live, AReplayMapsAsMapDoes) {
  const Workplace here;
  here.simulate_tank();
  const Outcome outcome = here.call({"live", "replay:tank.csv@max", "-o", "live.bt", "--quiet"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(here.call({"map", "tank.csv", "-o", "map.bt", "--quiet"}).status, 0);
  EXPECT_EQ(here.read("live.bt"), here.read("map.bt"));
}

TEST(Live, RefusesDevicesThatItDoesNotKnowAndFilesThatExist) {
  const Workplace here;
  expect_error(here.call({"live", "sonar", "-o", "a.bt"}), 2, {"no such device 'sonar'", "ping360:udp://HOST:PORT"});
  expect_error(here.call({"live", "replay:a.bin@0", "-o", "a.bt"}), 2, {"above 0"});
  expect_error(here.call({"live", "replay:a.bin", "-o", "a.bt", "--record", "b.bin"}), 2, {"--record"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "-"}), 2, {"-o -"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--sector", "60,-60"}), 2, {"--sector"});
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--step", "1"}), 2, {"multiple of 0.9"});
  here.write("dive.bin", "here already");
  expect_error(here.call({"live", "ping360:udp://127.0.0.1:9", "-o", "a.bt", "--record", "dive.bin"}), 1,
               {"dive.bin", "exists"});
  EXPECT_EQ(here.read("dive.bin"), "here already");
  expect_error(here.call({"emulate", "micron"}), 2, {"no such device 'micron'"});
}

}  // namespace
}  // namespace pingvox::test
