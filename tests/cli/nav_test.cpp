// Navigation logs: what they hold, and as CSV.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "call.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

constexpr const char* kNav =
    "# clock: unix\n"
    "time_s,source,quantity,x,y,z,sd_x,sd_y,sd_z,valid\n"
    "10,dvl,velocity,0.25,0,0,,,,1\n"
    "10.5,dvl,velocity,0.25,0,0,,,,0\n"
    "11,dvl,velocity,0.25,0\n"
    "11,bar,depth,5,,,,,,1\n";

TEST(Nav, InfoSaysWhatEachSourceHolds) {
  const Workplace here;
  here.write("nav.csv", kNav);
  const Outcome outcome = here.call({"info", "nav.csv", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* part :
       {R"("kind": "nav", "format": "csv", "clock": "unix", "records": 3)",
        R"("name": "dvl", "quantity": "velocity", "samples": 2, "invalid": 1, "rate_hz": 2, "gaps": 0, "from_s": 10)",
        R"("skipped": 1)", R"("what": "line that is no sample", "count": 1, "first_byte": 126)"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }

  const Outcome text = here.call({"info", "nav.csv"});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("velocity"));
  EXPECT_THAT(text.out, HasSubstr("first at byte"));
  expect_complaint(here.call({"info", "nav.csv", "--strict"}), 1, {"nav.csv", "line that is no sample"});
}

TEST(Nav, BecomesCsvAndNothingElse) {
  const Workplace here;
  here.write("nav.csv", kNav);
  const Outcome outcome = here.call({"convert", "nav.csv", "-o", "again.csv"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(here.read("again.csv"), HasSubstr("11,bar,depth,5,,,,,,1\n"));
  expect_complaint(here.call({"convert", "nav.csv", "-o", "map.bt"}), 2, {"nav.csv", "a navigation log"});
  expect_complaint(here.call({"map", "nav.csv", "-o", "map.bt"}), 1, {"nav.csv", "a navigation log"});
}

}  // namespace
}  // namespace pingvox::test
