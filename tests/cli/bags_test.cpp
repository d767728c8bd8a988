// ROS bags: beams and navigation in one file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "call.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

/// A bag of 6 lines of a Micron, with depths and poses.
const std::string kBag = PINGVOX_SOURCE_DIR "/fuzz/corpus/bag/none";
/// A bag of a DVL's velocities and echoes of a Ping360.
const std::string kMcap = PINGVOX_SOURCE_DIR "/fuzz/corpus/mcap/lz4";

TEST(Bags, InfoListsTopicsAndWhatTheyAreReadAs) {
  const Workplace here;
  const Outcome outcome = here.call({"info", kBag, "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part :
       {R"("kind": "log", "format": "bag", "beams": 6)", R"("skipped": 0)",
        R"({"name": "/scan_line", "type": "micron_driver_ros/ScanLine", "messages": 6, "read_as": "beams"})",
        R"("nav": {"clock": "unix", "records": 12)"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }
  const Outcome piped = here.call({"info", "-", "--json"}, {.in = here.read(kBag)});
  EXPECT_EQ(piped.out, outcome.out);
}

TEST(Bags, OneFileIsTheLogAndItsNavigation) {
  const Workplace here;
  const Outcome outcome = here.call({"map", kBag, "--nav", kBag, "-o", "net.bt", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(R"("beams": 6)"));
  EXPECT_THAT(outcome.out, HasSubstr(R"("attitude": "/pose", "position": "/pose", "poses": 6)"));
  ASSERT_EQ(here.call({"convert", kBag, "-o", "poses.tum"}).status, 0);
  EXPECT_THAT(here.read("poses.tum"), HasSubstr("1005.000000000 5 2 3 0 0 0 1"));
}

TEST(Bags, ATopicIsChosenByName) {
  const Workplace here;
  EXPECT_EQ(here.call({"convert", kMcap, "-o", "echoes.csv", "--topic", "/echo"}).status, 0);
  EXPECT_EQ(here.call({"render", kMcap, "-o", "echoes.png", "--topic", "/echo"}).status, 0);
  expect_error(here.call({"map", kMcap, "-o", "map.bt", "--topic", "/other"}), 1, {"lz4", "/other", "/echo"});
}

}  // namespace
}  // namespace pingvox::test
