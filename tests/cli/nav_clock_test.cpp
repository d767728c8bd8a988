// The clocks of navigation and of the sonar.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(NavClock, FindsTheOffsetBetweenTheClocks) {
  const Workplace here;
  // 2026-01-01 00:00:10 UTC, at noon in local time and in the name of the log.
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "beams.csv", "--turns", "2"}).status, 0);
  std::filesystem::copy_file(here.path("beams.csv"), here.path("20260101-120010000.csv"));
  const auto nav_from = [](double begin_s, const std::string& clock) {
    std::string nav = clock + "time_s,source,quantity,x,y,z\n";
    for (int i = 0; i <= 160; ++i) {
      nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},dvl,position,0,0,0\n", begin_s + i * 0.25);
    }
    return nav;
  };
  here.write("unix.csv", nav_from(1767225600.0, "# clock: unix\n"));
  here.write("boot.csv", nav_from(0.0, "# clock: boot\n"));
  here.write("unknown.csv", nav_from(0.0, ""));
  const auto map = [&](const std::string& log, const std::string& nav) {
    return here.call({"map", log, "--nav", nav, "-o", "map.bt"});
  };
  const Outcome by_name = map("20260101-120010000.csv", "unix.csv");
  ASSERT_EQ(by_name.status, 0) << by_name.err;
  EXPECT_THAT(
      by_name.out,
      HasSubstr("-1767225610.000 s: the date in the name of the sonar log, in UTC+12:00; not checked by the sonar\n"));
  EXPECT_THAT(map("beams.csv", "unknown.csv").out,
              HasSubstr("+0.000 s: assumed to be one clock; not checked by the sonar\n"));
  // The vehicle does not turn, and nothing else tells.
  expect_error(map("beams.csv", "unix.csv"), 1, {"beams.csv", "--nav-offset"});
  expect_error(map("beams.csv", "boot.csv"), 1, {"beams.csv", "--nav-offset"});
  here.write("20200926-110158491.csv", here.read("beams.csv"));
  expect_error(map("20200926-110158491.csv", "unix.csv"), 1,
               {"20200926-110158491.csv: does not overlap the navigation in time, whatever the time zone (by the date "
                "in its name the "
                "log ends 2020-09-26 11:02:",
                "the navigation begins 2026-01-01 00:00:00)"});
  const Outcome given =
      here.call({"map", "beams.csv", "--nav", "boot.csv", "--nav-offset", "0", "-o", "map.bt", "--json"});
  ASSERT_EQ(given.status, 0) << given.err;
  EXPECT_THAT(given.out, HasSubstr(R"("clock": {"offset_s": 0, "sd_s": null, "from": "--nav-offset"})"));
}

// Kills a zone that is one of several, or an offset of 0, where the logs leave open which zone the name is in.
TEST(NavClock, SeveralTimeZonesAreNamed) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "20260101-120010000.csv", "--turns", "2"}).status, 0);
  // From 09:00 to 13:00 UTC.
  std::string nav = "# clock: unix\ntime_s,source,quantity,x,y,z\n";
  for (int i = 0; i <= 4 * 360; ++i) {
    nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},dvl,position,0,0,0\n", 1767258000 + i * 10);
  }
  here.write("nav.csv", nav);
  const Outcome mapped = here.call({"map", "20260101-120010000.csv", "--nav", "nav.csv", "-o", "map.bt"});
  expect_error(
      mapped, 1,
      {"its name says 2026-01-01 12:00:10 to 2026-01-01 12:00:",
       "the navigation is of 2026-01-01 09:00:00 to 2026-01-01 13:00:00: in UTC+0:00 --nav-offset -1767268810.000, "
       "in UTC+1:00 --nav-offset -1767265210.000, in UTC+2:00 "});
}

// Kills a log on another clock that makes no path, but stretches its time until it overlaps anything.
TEST(NavClock, TheTimesOfThePathDecideAboutTheClock) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "20260101-120010000.csv", "--turns", "2"}).status, 0);
  std::string nav = "# clock: unix\ntime_s,source,quantity,x,y,z\n", other = nav;
  for (int i = 0; i <= 160; ++i) {
    nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},dvl,position,0,0,0\n", 1767225600.0 + i * 0.25);
    other += fmt::format("{},A50,velocity,0,0,0\n", 1.56e9 + i * 0.25);
  }
  here.write("nav.csv", nav);
  here.write("other.csv", other);
  const Outcome mapped =
      here.call({"map", "20260101-120010000.csv", "--nav", "nav.csv", "--nav", "other.csv", "-o", "map.bt"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("the date in the name of the sonar log, in UTC+12:00"));
}

// Kills logs that are aligned only with the first one, or not at all behind one whose clock is not known.
TEST(NavClock, LogsAreAlignedInAnyOrder) {
  const Workplace here;
  here.simulate_tank();
  const auto nav_of = [](const char* clock, const char* name, int from_s, int to_s, double zero_s) {
    std::string nav = fmt::format("# clock: {}\ntime_s,source,quantity,x,y,z\n", clock);
    for (double time_s = from_s; time_s <= to_s; time_s += 0.5) {
      const double yaw_rad = 0.6 * std::sin(0.047 * time_s) + 0.2 * std::sin(0.171 * time_s + 1.0);
      nav += fmt::format("{0},{1},attitude,0,0,{2}\n{0},{1},position,0,0,0\n", time_s - zero_s, name, yaw_rad);
    }
    return nav;
  };
  here.write("short.csv", nav_of("unix", "ahrs", 0, 22, 0.0));
  here.write("long.csv", nav_of("unix", "ahrs", 22, 190, 0.0));
  here.write("boot.csv", nav_of("boot", "ATT", 15, 180, 5.0));
  here.write("apart.csv", nav_of("boot", "ATT", 400, 410, 5.0));
  here.write("unknown.csv", "time_s,source,quantity,x,y,z\n0,bar,depth,1,,\n40,bar,depth,1,,\n");
  const auto map = [&](const std::vector<std::string>& navs) {
    std::vector<std::string> words = {"map", "tank.csv", "-o", "o.bt", "--nav-offset", "0"};
    for (const std::string& nav : navs) words.insert(words.end(), {"--nav", nav});
    return here.call(words);
  };
  std::vector<std::string> navs = {"boot.csv", "long.csv", "short.csv"};
  int orders = 0;
  do {
    const Outcome mapped = map(navs);
    EXPECT_EQ(mapped.status, 0) << navs[0] << ", " << navs[1] << ": " << mapped.err;
    ++orders;
  } while (std::ranges::next_permutation(navs).found);
  EXPECT_EQ(orders, 6);
  expect_error(map({"unknown.csv", "long.csv", "apart.csv"}), 1,
               {"apart.csv: the offset between its clock and that of long.csv cannot be found"});
}

// Refused were logs of one day "as it is of 2023-05-17, the navigation is of 2023-05-17", and those that do not overlap
// with "the offset is not known".
TEST(NavClock, ThatDoesNotOverlapIsRefusedWithTheTimesOfBoth) {
  const Workplace here;
  constexpr double kTen_s = 1'684'317'600.0;  // 2023-05-17 10:00:00
  const auto beams_from = [](double from_s) {
    std::string log = "time_s,bearing_deg,bin_length_m,intensities\n";
    for (int i = 0; i < 40; ++i) log += fmt::format("{},{},0.1,1,2,3,9,2,1\n", from_s + 0.25 * i, 9 * i);
    return log;
  };
  const auto nav_from = [](const char* clock, double from_s, double to_s) {
    std::string nav = fmt::format("# clock: {}\ntime_s,source,quantity,x,y,z\n", clock);
    for (double time_s = from_s; time_s <= to_s; time_s += 1.0) {
      nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},dvl,position,0,0,0\n", time_s);
    }
    return nav;
  };
  here.write("dive.csv", beams_from(kTen_s + 4 * 3600 + 12));
  here.write("morning.csv", nav_from("unix", kTen_s, kTen_s + 723));
  here.write("never.csv", nav_from("unix", 100, 130));
  here.write("start.csv", nav_from("", 100, 130));
  here.write("short.csv", beams_from(0.0));
  const auto map = [&](const char* log, const char* nav) {
    return here.call({"map", log, "--nav", nav, "-o", "o.bt"});
  };
  // The same logs, four hours and twelve seconds apart: a zone of UTC+4 would make up for it.
  EXPECT_THAT(map("dive.csv", "morning.csv").out, HasSubstr("both have dates, the sonar log's in UTC+4:00"));
  here.write("dive.csv", beams_from(kTen_s + 1.5 * 3600));
  expect_error(map("dive.csv", "morning.csv"), 1,
               {"dive.csv: does not overlap the navigation in time, whatever the time zone (the navigation ends "
                "2023-05-17 10:12:03, the log "
                "begins 2023-05-17 11:30:00)"});
  expect_error(map("dive.csv", "never.csv"), 1,
               {"the navigation ends 130.000 s, the log begins 2023-05-17 11:30:00", "of a clock that was not set"});
  expect_error(
      map("short.csv", "start.csv"), 1,
      {"short.csv: does not overlap the navigation in time (the log ends 9.750 s, the navigation begins 100.000 s)"});
  expect_error(map("short.csv", "morning.csv"), 1,
               {"is not known (the log ends 9.750 s, the navigation begins 2023-05-17 10:00:00)"});
}

// Logs of one vehicle were put on one clock, and nothing said by how much, how, and how surely.
TEST(NavClock, TheReportTellsHowTheClocksOfItsLogsAreJoined) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "dive.csv", "--trajectory", "loop", "--turns", "2"}).status, 0);
  constexpr double kDate_s = 1'684'317'600.0;
  const auto nav_of = [](const char* clock, const char* samples, double zero_s) {
    std::string nav = fmt::format("# clock: {}\ntime_s,source,quantity,x,y,z\n", clock);
    for (double time_s = 0.0; time_s <= 190.0; time_s += 0.5) {
      const double yaw_rad = 0.6 * std::sin(0.047 * time_s) + 0.2 * std::sin(0.171 * time_s + 1.0);
      nav += fmt::format(fmt::runtime(samples), fmt::arg("t", time_s + zero_s), fmt::arg("yaw", yaw_rad));
    }
    return nav;
  };
  constexpr const char* kTurns = "{t},ahrs,attitude,0,0,{yaw}\n";
  here.write("boot.csv", nav_of("boot", "{t},ATT,attitude,0,0,{yaw}\n{t},ATT,velocity,0.1,0,0\n", 5.0));
  here.write("dated.csv", nav_of("unix", kTurns, kDate_s));
  here.write("also.csv", nav_of("unix", "{t},bar,depth,2,,\n", kDate_s));
  here.write("never.csv", nav_of("unix", "{t},mru,attitude,0,0,{yaw}\n", 300.0));
  const std::vector<std::string> navs = {
      "--nav",    "dated.csv", "--nav",     "boot.csv",     "--nav",
      "also.csv", "--nav",     "never.csv", "--nav-offset", fmt::format("{}", -kDate_s)};
  const auto call = [&](std::vector<std::string> words) {
    words.insert(words.end(), navs.begin(), navs.end());
    return here.call(words);
  };
  for (const std::vector<std::string>& words : {std::vector<std::string>{"map", "dive.csv", "-o", "o.bt"},
                                                {"slam", "dive.csv", "-o", "o.tum", "--matching", "none"},
                                                {"locate", "dive.csv", "--map", "o.bt", "-o", "o.tum"}}) {
    SCOPED_TRACE(words[0]);
    const Outcome said = call(words);
    ASSERT_EQ(said.status, 0) << said.err;
    EXPECT_THAT(said.out,
                testing::ContainsRegex("nav log     boot.csv: .1684317(594.99|595.00). s .sd [0-9.]+ s. to the "
                                       "clock of dated.csv: how the vehicle turns"));
    EXPECT_THAT(said.out, HasSubstr("nav log     also.csv: +0.000 s to the clock of dated.csv: both have dates\n"));
    EXPECT_THAT(said.out, testing::ContainsRegex("nav log     never.csv: .1684317(299.99|300.00). s .sd "));
    std::vector<std::string> with_json = words;
    with_json.emplace_back("--json");
    const Outcome json = call(with_json);
    ASSERT_EQ(json.status, 0) << json.err;
    EXPECT_THAT(json.out, HasSubstr(R"(logs": [)"));
    EXPECT_THAT(json.out,
                HasSubstr(R"({"name": "also.csv", "offset_s": 0, "sd_s": null, "from": "both have dates", )"));
  }
  const Outcome one = here.call({"map", "dive.csv", "-o", "o.bt", "--nav", "boot.csv", "--nav-offset", "-5"});
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_THAT(one.out, Not(HasSubstr("nav log ")));
}

/// An attitude in a log of telemetry, behind its time.
std::string tlog_of(const std::vector<double>& times_s) {
  std::string log;
  for (const double time_s : times_s) {
    const auto time_us = static_cast<std::uint64_t>(std::llround(time_s * 1e6));
    for (int shift = 56; shift >= 0; shift -= 8) log += static_cast<char>(time_us >> shift & 0xffU);
    for (const unsigned byte :
         {0xfdU, 0x1cU, 0x00U, 0x00U, 0xecU, 0x01U, 0x01U, 0x1eU, 0x00U, 0x00U, 0x53U, 0x84U, 0x0aU, 0x00U,
          0x9cU, 0x11U, 0xc7U, 0xbcU, 0x2bU, 0x3eU, 0xcaU, 0x3cU, 0xa0U, 0x45U, 0x16U, 0xc0U, 0x16U, 0x73U,
          0xbfU, 0xbcU, 0x59U, 0x0eU, 0x30U, 0x3cU, 0x07U, 0x07U, 0x37U, 0xbaU, 0x07U, 0xbaU}) {
      log += static_cast<char>(byte);
    }
  }
  return log;
}

// Logs of a computer without a clock were no logs, or half of one, and nothing named the clock.
TEST(NavClock, InfoNamesAClockThatWasNotSetOrSetMeanwhile) {
  const Workplace here;
  const auto info = [&](const std::string& name, const std::string& bytes) {
    here.write(name, bytes);
    const Outcome said = here.call({"info", name});
    EXPECT_EQ(said.status, 0) << said.err;
    return said.out;
  };
  const auto line_at = [](double time_s) { return fmt::format("{},bar,depth,1\n", time_s); };
  const std::string head = "# clock: unix\ntime_s,source,quantity,x\n";
  constexpr double kDate_s = 1'684'351'479.0;
  const std::string never = info("never.tlog", tlog_of({100.0, 100.1, 100.2}));
  EXPECT_THAT(never, HasSubstr("records     3\n"));
  EXPECT_THAT(never,
              HasSubstr("clock       unix, 100.000 to 100.000 s since 1970: the clock of the computer was not set\n"));
  const std::string set = info("set.tlog", tlog_of({100.0, 100.1, kDate_s, kDate_s + 0.1}));
  EXPECT_THAT(set, HasSubstr("records     4\n"));
  EXPECT_THAT(set, HasSubstr("clock set   by +1684351379.000 s at 1684351479.000 s, 2023-05-17 19:24:39: all times"));
  const std::string back = info("back.tlog", tlog_of({kDate_s, kDate_s + 0.1, 100.0, 100.1}));
  EXPECT_THAT(back, HasSubstr("clock set   by -1684351379"));
  EXPECT_THAT(back, HasSubstr(", 2023-05-17 19:24:39 to 2023-05-17 19:24:39 UTC"));
  EXPECT_THAT(here.call({"info", "set.tlog", "--json"}).out, HasSubstr(R"("clock_set": [)"));

  EXPECT_THAT(info("never.csv", head + line_at(100) + line_at(101)),
              HasSubstr("the clock of the computer was not set\n"));
  EXPECT_THAT(info("set.csv", head + line_at(100) + line_at(kDate_s)),
              HasSubstr("100.000 s since 1970 to 2023-05-17 19:24:39 UTC: the clock was not set all the time\n"));
  EXPECT_THAT(info("back.csv", head + line_at(kDate_s) + line_at(100) + line_at(101)),
              HasSubstr("clock back  depth of bar by 1684351379.000 s"));
  EXPECT_THAT(info("swapped.csv",
                   head + line_at(kDate_s) + line_at(kDate_s + 3) + line_at(kDate_s + 1.5) + line_at(kDate_s + 4.5)),
              HasSubstr("late        1 sample of depth of bar, put in order: messages were swapped\n"));
}

// A sonar log in which two messages were swapped was refused, and nothing told such a log from one whose clock was set
// back.
TEST(NavClock, BeamsThatWereSwappedAreSaidAndPutInOrder) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "dive.csv", "--turns", "2", "--nav", "nav.csv"}).status, 0);
  std::vector<std::string> lines;
  std::istringstream log(here.read("dive.csv"));
  for (std::string line; std::getline(log, line);) lines.push_back(line + "\n");
  const auto joined = [&] {
    std::string text;
    for (const std::string& line : lines) text += line;
    return text;
  };
  ASSERT_GT(lines.size(), 200U);
  std::rotate(lines.begin() + 100, lines.begin() + 101, lines.begin() + 131);
  here.write("swapped.csv", joined());
  const auto slam = [&](const char* name) { return here.call({"slam", name, "--nav", "nav.csv", "-o", "o.tum"}); };
  const Outcome as_it_was = slam("dive.csv");
  ASSERT_EQ(as_it_was.status, 0) << as_it_was.err;
  const std::string poses = here.read("o.tum");
  const Outcome info = here.call({"info", "swapped.csv"});
  EXPECT_THAT(info.out, HasSubstr("late        1 beam behind a later one: messages were swapped\n"));
  const Outcome swapped = slam("swapped.csv");
  ASSERT_EQ(swapped.status, 0) << swapped.err;
  EXPECT_EQ(here.read("o.tum"), poses);
}

// Kills navigation that is joined to times made up for a log without any, whatever the offset is known from.
TEST(NavClock, IsRefusedForALogWithoutTimes) {
  const Workplace here;
  std::string log;
  for (int i = 0; i < 40; ++i) {
    const int angle = 10 * i, sum = 1264 + angle % 256 + angle / 256;
    log += fmt::format(
        "ID: 2300 - device_data\n"
        "Header: start_1: 66 start_2: 82 payload_length: 18 message_id: 2300 src_device_id: 2 dst_device_id: 0\n"
        "- mode: 0\n- gain_setting: 0\n- angle: {}\n- transmit_duration: 16\n- sample_period: 90\n"
        "- transmit_frequency: 1000\n- number_of_samples: 4\n- data_length: 4\n"
        "- data: ['0x4c', '0x98', '0x4', '0xff']\nChecksum: {}\n",
        angle, sum);
  }
  here.write("log.txt", log);
  here.write("nav.csv",
             "time_s,source,quantity,x,y,z\n0,a,attitude,0,0,0\n0,a,position,0,0,0\n9,a,attitude,0,0,1\n"
             "9,a,position,0,0,0\n");
  const Outcome info = here.call({"info", "log.txt"});
  EXPECT_THAT(info.out, HasSubstr("beams       40\n"));
  EXPECT_THAT(info.out, HasSubstr("not known: the log has no times"));
  EXPECT_EQ(here.call({"map", "log.txt", "-o", "map.bt"}).status, 0);
  for (const std::vector<std::string>& offset : {std::vector<std::string>{}, {"--nav-offset", "0"}}) {
    for (std::vector<std::string> call : {std::vector<std::string>{"map", "log.txt", "-o", "o.bt"},
                                          {"slam", "log.txt", "-o", "o.tum"},
                                          {"locate", "log.txt", "--map", "map.bt", "-o", "o.tum"}}) {
      call.insert(call.end(), {"--nav", "nav.csv"});
      call.insert(call.end(), offset.begin(), offset.end());
      expect_error(here.call(call), 1, {"log.txt: has no times"});
    }
  }
}

// Kills a time of day that is added to the time of day in the name, and one that is taken as a time since 1970.
TEST(NavClock, TimesOfDayCountFromMidnightOfTheDateInTheName) {
  const Workplace here;
  std::string log;
  for (int i = 0; i < 40; ++i) {
    log += fmt::format("SON,12:00:{:02}.000,2,16,8967,60,84,0,8,81,0,6399,16,{},4,0,9,80,9\n", i, 160 * i);
  }
  here.write("20260101-120000000.csv", log);
  std::string nav = "# clock: unix\ntime_s,source,quantity,x,y,z\n";
  for (int i = 0; i <= 160; ++i) {
    nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},dvl,position,0,0,0\n", 1767261600.0 + i * 0.25);
  }
  here.write("nav.csv", nav);
  const Outcome mapped = here.call({"map", "20260101-120000000.csv", "--nav", "nav.csv", "-o", "map.bt"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("-1767218400.000 s: the date in the name of the sonar log, in UTC+2:00"));
}

// A vehicle that turns on the spot, to and fro; its poses on the clock of the log and on one that is late.
// Kills a clock that is not checked, one that is right and named, and an offset of the other sign.
TEST(NavClock, APathOnAnotherClockIsNamed) {
  const Workplace here;
  const auto yaw_rad = [](double time_s) {
    return 0.6 * std::sin(0.047 * time_s) + 0.2 * std::sin(0.171 * time_s + 1.0);
  };
  for (const double late_s : {0.0, 4.0}) {
    std::string poses;
    for (double time_s = 0.0; time_s <= 150.0; time_s += 0.5) {
      const double half_rad = 0.5 * yaw_rad(time_s);
      poses += fmt::format("{} 0.5 -0.3 0 0 0 {} {}\n", time_s + late_s, std::sin(half_rad), std::cos(half_rad));
    }
    here.write(late_s == 0.0 ? "poses.tum" : "late.tum", poses);
  }
  const Outcome simulated = here.call({"simulate", "tank", "--poses", "poses.tum", "-o", "log.csv"});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const auto said_of = [&](const char* poses, const char* mount) {
    const Outcome mapped =
        here.call({"map", "log.csv", "--poses", poses, "--mount", mount, "--resolution", "0.2", "-o", "x.bt"});
    EXPECT_EQ(mapped.status, 0) << mapped.err;
    return mapped.err;
  };
  EXPECT_THAT(said_of("poses.tum", "0,0,0,0,0,0"), Not(HasSubstr("right?")));
  const std::string late = said_of("late.tum", "0,0,0,0,0,0");
  EXPECT_THAT(late, HasSubstr("log.csv: by the rotation of the sonar image -4.0 +- 0."));
  EXPECT_THAT(late, HasSubstr("is the clock of --poses right?"));
  // A head that turns about a level axis sees nothing of how the vehicle turns.
  EXPECT_THAT(said_of("late.tum", "0,0,0,90,0,0"), Not(HasSubstr("right?")));

  // The same as navigation.
  std::string nav = "time_s,source,quantity,x,y,z\n";
  for (double time_s = 0.0; time_s <= 150.0; time_s += 0.5) {
    nav += fmt::format("{0},ahrs,attitude,0,0,{1}\n{0},dvl,position,0.5,-0.3,0\n", time_s + 4.0, yaw_rad(time_s));
  }
  here.write("nav.csv", nav);
  const Outcome mapped =
      here.call({"map", "log.csv", "--nav", "nav.csv", "--resolution", "0.2", "-o", "x.bt", "--json"});
  const auto json = flat_json(mapped.out);
  ASSERT_TRUE(json) << mapped.out;
  EXPECT_NEAR(std::stod(json->at("nav.clock_check.offset_s")), -4.0, 0.3);
  EXPECT_THAT(mapped.err, HasSubstr("should be added to the times of the poses: try --nav-offset "));
}

// Kills a map whose place on Earth nobody can tell.

}  // namespace
}  // namespace pingvox::test
