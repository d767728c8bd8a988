// `pingvox live --slam` against emulated devices.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>

#include "call.hpp"
#include "live_head.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

// That its poses are right is tested in virtual time, in tests/live.
TEST(LiveSlam, WritesTheMapAndThePathOfAnEmulatedDvl) {
  const Head head({"--world", "harbour", "--trajectory", "loop", "--speed", "0.5"}, "100");
  const Workplace here;
  const pid_t dvl = here.start({"emulate", "a50", "--listen", "tcp://127.0.0.1:0", "--world", "harbour", "--trajectory",
                                "loop", "--speed", "0.5", "--rate", "20"},
                               {.out_path = here.path("address")});
  EXPECT_TRUE(wait_until([&] { return here.has("address") && here.read("address").find('\n') != std::string::npos; }));
  const std::string address = here.read("address");
  const Outcome live =
      here.call({"live",     head.address(), "--nav",    "a50:" + address.substr(0, address.find('\n')),
                 "--slam",   "-o",           "live.bt",  "--poses-out",
                 "live.tum", "--record",     "dive.bin", "--range",
                 "8",        "--step",       "9",        "--resolution",
                 "0.2",      "--beams",      "900",      "--json"});
  ::kill(dvl, SIGTERM);
  EXPECT_EQ(status_of(dvl), 0);
  ASSERT_EQ(live.status, 0) << live.err;
  EXPECT_THAT(live.err, HasSubstr("slam: motion from the velocity of A50 and the heading of A50, "));
  EXPECT_THAT(live.out, HasSubstr(R"("slam": {"motion": "velocity", "velocity": "A50", "heading": "A50", )"));
  EXPECT_TRUE(here.has("live.bt"));

  const Outcome along = here.call({"map", "dive.bin", "--poses", "live.tum", "-o", "map.bt", "--resolution", "0.2"});
  EXPECT_EQ(along.status, 0) << along.err;
  const Outcome again = here.call({"slam", "dive.bin", "--nav", "dive.jsonl", "--causal", "-o", "slam.tum"});
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST(LiveSlam, GoesBySonarAlone) {
  const Head head({}, "100");
  const Workplace here;
  const Outcome live =
      here.call({"live", head.address(), "--slam", "-o", "live.bt", "--range", "4", "--step", "3.6", "--beams", "700"});
  ASSERT_EQ(live.status, 0) << live.err;
  EXPECT_THAT(live.err, HasSubstr("slam: no velocity and no heading: motion from the sonar alone"));
  EXPECT_THAT(live.out, HasSubstr("motion from sonar odometry and sonar odometry"));
}

TEST(LiveSlam, OptionsThatNeedIt) {
  const Workplace here;
  const std::string head = "ping360:udp://127.0.0.1:1";
  expect_error(here.call({"live", head, "-o", "a.bt", "--poses-out", "a.tum"}), 2, {"--poses-out", "--slam"});
  expect_error(here.call({"live", head, "-o", "a.bt", "--nav-mount", "A50=0,0,0,0,0,45"}), 2,
               {"--nav-mount", "--slam"});
  expect_error(here.call({"live", head, "-o", "a.bt", "--slam", "--poses-out", "a.csv"}), 2, {"a.csv", ".tum"});
  expect_error(here.call({"live", head, "-o", "a.bt", "--map", "b.bt"}), 2, {"--map", "--slam"});
  expect_error(here.call({"live", head, "-o", "a.bt", "--slam", "--start", "1,2,3"}), 2, {"--start", "--map"});
  expect_error(here.call({"live", head, "-o", "a.bt", "--slam", "--map", "a.bt"}), 2, {"a.bt"});
  expect_error(here.call({"live", head, "-o", "a.bt", "--slam", "--map", "b.bt", "--resolution", "0.1"}), 2,
               {"--resolution", "--map"});
  expect_error(here.call({"live", head, "-o", "a.bt", "--slam", "--map", "nowhere.bt"}), 1, {"nowhere.bt"});
}

}  // namespace
}  // namespace pingvox::test
