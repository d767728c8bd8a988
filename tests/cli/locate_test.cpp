// A vehicle in a map that is known.

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "call.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Locate, FindsTheSonarInTheTankOfAnotherRun) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "a.csv", "--turns", "2", "--seed", "1"}).status, 0);
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "b.csv", "--turns", "3", "--seed", "2"}).status, 0);
  ASSERT_EQ(here.call({"map", "a.csv", "-o", "a.bt"}).status, 0);
  const Outcome found = here.call({"locate", "b.csv", "--map", "a.bt", "-o", "b.tum", "--json"});
  ASSERT_EQ(found.status, 0) << found.err;
  for (const char* part : {R"("sure": true)", R"("hypotheses": [)", R"("converged_at_s": )",
                           R"("particles": {"mean": )", R"("seconds": {"read": )"}) {
    EXPECT_THAT(found.out, HasSubstr(part));
  }
  // The sonar stands at the origin of both maps.
  std::istringstream poses(here.read("b.tum"));
  std::size_t count = 0;
  for (std::string line; std::getline(poses, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream numbers(line);
    double time = 0.0, x = 1e9, y = 1e9;
    numbers >> time >> x >> y;
    ASSERT_LT(std::hypot(x, y), 0.08) << line;
    ++count;
  }
  EXPECT_GT(count, 300U);
}

// Kills a trajectory that is the filter's although all of the recording says more.
TEST(Locate, AllOfTheRecordingTellsMoreThanWhatWasKnownThen) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "a.csv", "--trajectory", "loop", "--nav", "nav.csv", "--nav-delay",
                       "0", "--truth", "t", "--resolution", "0.05", "--seed", "11"})
                .status,
            0);
  const auto locate = [&](std::vector<std::string> more) {
    std::vector<std::string> call = {"locate",       "a.csv", "--map", "t/world.bt", "--nav", "nav.csv",
                                     "--nav-offset", "0",     "-o",    "a.tum",      "--json"};
    call.insert(call.end(), more.begin(), more.end());
    const Outcome found = here.call(call);
    EXPECT_EQ(found.status, 0) << found.err;
    EXPECT_EQ(found.out.find(R"("smoothed": 0)") == std::string::npos, more.empty()) << found.out;
    const std::string compared = here.call({"compare", "a.tum", "t/poses.tum", "--json"}).out;
    const std::string before = R"("none": {"mean": )";
    const std::size_t at = compared.find(before);
    return at == std::string::npos ? 1e9 : std::stod(compared.substr(at + before.size()));
  };
  EXPECT_LT(locate({}), 0.08);
  EXPECT_GT(locate({"--causal"}), 0.1);
}

TEST(Locate, TheSameSeedWritesTheSameBytesAndAStartNeedsNoSearch) {
  const Workplace here;
  ASSERT_EQ(
      here.call({"simulate", "tank", "-o", "a.csv", "--turns", "1", "--truth", "t", "--resolution", "0.1"}).status, 0);
  for (const char* name : {"a.tum", "b.tum"}) {
    ASSERT_EQ(here.call({"locate", "a.csv", "--map", "t/world.bt", "-o", name, "--start", "0.1,0,5,0.2,5"}).status, 0);
  }
  EXPECT_EQ(here.read("a.tum"), here.read("b.tum"));
  EXPECT_THAT(here.read("a.tum"), HasSubstr("\n0.000000000 "));
}

// Kills poses that are written as if they were right although several places fit.
TEST(Locate, SaysWhichPosesMayBeWrongAndLeavesThemOut) {
  const Workplace here;
  // One turn of the head: no other one says the same.
  ASSERT_EQ(
      here.call({"simulate", "tank", "-o", "a.csv", "--turns", "1", "--truth", "t", "--resolution", "0.1"}).status, 0);
  std::vector<std::string> call = {"locate", "a.csv", "--map", "t/world.bt", "-o", "o.tum"};
  const Outcome all = here.call(call);
  EXPECT_EQ(all.status, 0);
  EXPECT_THAT(all.err, testing::AllOf(HasSubstr("1 of 1 poses may be wrong"), HasSubstr("--only-sure")));
  EXPECT_TRUE(here.has("o.tum"));
  call[5] = "sure.tum";
  call.emplace_back("--only-sure");
  const Outcome sure = here.call(call);
  EXPECT_EQ(sure.status, 1);
  EXPECT_THAT(sure.err, testing::StartsWith("pingvox: a.csv: no pose of the vehicle is certain"));
  EXPECT_THAT(sure.out, testing::StartsWith("no trajectory is written\n"));
  EXPECT_FALSE(here.has("sure.tum"));
}

TEST(Locate, SaysWhatIsWrongWithItsWordsAndFiles) {
  const Workplace here;
  ASSERT_EQ(
      here.call({"simulate", "tank", "-o", "a.csv", "--turns", "1", "--truth", "t", "--resolution", "0.1"}).status, 0);
  expect_error(here.call({"locate", "a.csv", "-o", "o.tum"}), 2, {"--map is missing"});
  for (const char* start : {"here", "1,2", "1,2,nan", "1,2,3,-1,5", "1e300,0,0"}) {
    expect_error(here.call({"locate", "a.csv", "--map", "t/world.bt", "-o", "o.tum", "--start", start}), 2,
                 {"--start"});
  }
  expect_error(here.call({"locate", "a.csv", "--map", "t/world.bt", "-o", "o.tum", "--start", "100,100,0"}), 2,
               {"--start: 100, 100 is outside of t/world.bt"});
  expect_error(here.call({"locate", "a.csv", "--map", "t/world.bt", "-o", "o.tum", "--min-z", "50", "--max-z", "51"}),
               1,
               {"t/world.bt", "nothing is occupied between the heights 50 and 51 m", "the map has x ",
                "the sonar is at z = 0.00 m"});
  here.write("late.tum", "5000 0 0 0 0 0 0 1\n5001 0 0 0 0 0 0 1\n");
  expect_error(here.call({"locate", "a.csv", "--map", "t/world.bt", "-o", "o.tum", "--odometry", "late.tum"}), 1,
               {"do not overlap in time"});
  here.write("depth.csv", "time_s,source,quantity,x\n1,bar,depth,2\n2,bar,depth,2\n");
  expect_error(here.call({"locate", "a.csv", "--map", "t/world.bt", "-o", "o.tum", "--nav", "depth.csv"}), 1,
               {"depth.csv", "no valid heading or attitude"});
  EXPECT_FALSE(here.has("o.tum"));
}

// Kills an error of the smoother that is taken for a map that does not fit.
TEST(Locate, AMountOfAnUnknownSourceIsInvalid) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "a.csv", "--trajectory", "loop", "--turns", "2", "--nav", "nav.csv",
                       "--nav-delay", "0"})
                .status,
            0);
  ASSERT_EQ(here.call({"map", "a.csv", "-o", "a.bt"}).status, 0);
  expect_error(here.call({"locate", "a.csv", "--map", "a.bt", "--nav", "nav.csv", "--nav-offset", "0", "--nav-mount",
                          "dlv=0,0,0,0,0,9", "-o", "a.tum"}),
               2, {"nav.csv", "dlv", "DVL"});
}

// Kills a clock of the navigation that is taken for the sonar's without a word.
TEST(Locate, NavigationOnAnotherClockIsMovedOrRefused) {
  const Workplace here;
  ASSERT_EQ(
      here.call({"simulate", "tank", "-o", "a.csv", "--turns", "2", "--truth", "t", "--resolution", "0.1"}).status, 0);
  std::string nav = "# clock: unix\ntime_s,source,quantity,x,y,z\n";
  for (int i = 0; i <= 80; ++i) {
    nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},dvl,velocity,0,0,0\n", 1767225600.0 + i * 0.25);
  }
  here.write("nav.csv", nav);
  const std::vector<std::string> call = {"locate",  "a.csv", "--map", "t/world.bt", "--nav",
                                         "nav.csv", "-o",    "o.tum", "--json"};
  expect_error(here.call(call), 1, {"a.csv", "--nav-offset"});
  std::vector<std::string> given = call;
  given.insert(given.end(), {"--nav-offset", "-1767225600"});
  const Outcome found = here.call(given);
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr(R"("nav_clock": {"offset_s": -1767225600, "sd_s": null, "from": "--nav-offset"})"));
}

TEST(Locate, NamesAnOffsetOfTheClockThatTheSonarContradicts) {
  PINGVOX_SKIP_WITH_OTHER_PROGRAM();
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "harbour", "-o", "a.csv", "--trajectory", "loop", "--nav", "nav.csv", "--nav-delay",
                       "0", "--truth", "t", "--resolution", "0.1"})
                .status,
            0);
  const auto located = [&](const char* offset_s) {
    return here.call({"locate", "a.csv", "--map", "t/world.bt", "--nav", "nav.csv", "--nav-offset", offset_s, "-o",
                      "a.tum", "--json"});
  };
  const Outcome right = located("0"), wrong = located("5");
  EXPECT_THAT(right.out, HasSubstr(R"("clock_check": {"offset_s": )"));
  EXPECT_THAT(right.err, Not(HasSubstr("right?")));
  EXPECT_THAT(wrong.err, HasSubstr("should be added to the times of the poses: try --nav-offset "));
}

}  // namespace
}  // namespace pingvox::test
