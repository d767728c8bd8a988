// Navigation logs: what they hold, and as CSV.

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
        R"("skipped": 1)", R"("what": "line that is not a sample", "count": 1, "first_byte": 126)"}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }

  const Outcome text = here.call({"info", "nav.csv"});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("velocity"));
  EXPECT_THAT(text.out, HasSubstr("first at byte"));
  expect_error(here.call({"info", "nav.csv", "--strict"}), 1, {"nav.csv", "line that is not a sample"});
}

TEST(Nav, InfoSaysDatesWhereTheClockHasThem) {
  const Workplace here;
  here.write("nav.csv", "# clock: unix\ntime_s,source,quantity,x\n1767225600.5,bar,depth,5\n1767225661,bar,depth,5\n");
  EXPECT_THAT(here.call({"info", "nav.csv"}).out, HasSubstr("unix, 2026-01-01 00:00:00 to 2026-01-01 00:01:01 UTC\n"));
  here.write("beams.csv", "time_s,bearing_deg,bin_length_m,intensities\n1767225600.5,0,0.1,1,2,3\n");
  EXPECT_THAT(here.call({"info", "beams.csv"}).out,
              HasSubstr("from 1767225600.500 s, 2026-01-01 00:00:00 by its clock\n"));
  here.write("beams.csv", "time_s,bearing_deg,bin_length_m,intensities\n12.5,0,0.1,1,2,3\n");
  EXPECT_THAT(here.call({"info", "beams.csv"}).out, HasSubstr("from 12.500 s\n"));
}

TEST(Nav, RefusesOtherDvlsByName) {
  const Workplace here;
  here.write("dive.pd0", "\x7f\x7f\x10\x01");
  here.write("dive.pd6", ":SA,+0.12,-3.40,91.20\r\n:TS,26112317040000,35.0,+12.5,0.0,1500.0,0\r\n");
  here.write("beams.csv", "time_s,bearing_deg,bin_length_m,intensities\n0,0,0.1,1,2,3\n");
  for (const auto& [file, name] : {std::pair("dive.pd0", "PD0"), std::pair("dive.pd6", "PD6")}) {
    expect_error(here.call({"info", file}), 1, {file, name});
    expect_error(here.call({"map", "beams.csv", "--nav", file, "-o", "map.bt"}), 1, {file, name});
  }
}

TEST(Nav, BecomesCsvAndNothingElse) {
  const Workplace here;
  here.write("nav.csv", kNav);
  const Outcome outcome = here.call({"convert", "nav.csv", "-o", "again.csv"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(here.read("again.csv"), HasSubstr("11,bar,depth,5,,,,,,1\n"));
  expect_error(here.call({"convert", "nav.csv", "-o", "map.bt"}), 2, {"nav.csv", "a navigation log"});
  expect_error(here.call({"map", "nav.csv", "-o", "map.bt"}), 1, {"nav.csv", "a navigation log"});
}

/// The poses of a TUM file as a sensor log would have them.
std::string nav_of_poses(const std::string& tum, double clock_s) {
  std::string nav = "time_s,source,quantity,x,y,z\n";
  std::istringstream lines(tum);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream fields(line);
    double t = 0, x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 0;
    fields >> t >> x >> y >> z >> qx >> qy >> qz >> qw;
    const double roll = std::atan2(2 * (qw * qx + qy * qz), 1 - 2 * (qx * qx + qy * qy));
    const double pitch = std::asin(2 * (qw * qy - qz * qx));
    const double yaw = std::atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz));
    nav += fmt::format("{0},ahrs,attitude,{1},{2},{3}\n{0},dvl,position,{4},{5},{6}\n", t + clock_s, roll, pitch, yaw,
                       x, y, z);
  }
  return nav;
}

TEST(Nav, MapsAsTheSamePosesDo) {
  const Workplace here;
  ASSERT_EQ(
      here.call({"simulate", "tank", "-o", "dive.csv", "--trajectory", "loop", "--turns", "2", "--seed", "3"}).status,
      0);
  here.write("nav.csv", nav_of_poses(here.read("dive.tum"), -128.0));
  ASSERT_EQ(here.call({"map", "dive.csv", "--poses", "dive.tum", "-o", "poses.ot"}).status, 0);
  const Outcome mapped = here.call({"map", "dive.csv", "--nav", "nav.csv", "--nav-offset", "128", "-o", "nav.ot"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("from ahrs and dvl\n"));
  EXPECT_EQ(mapped.err, "") << "no beam is skipped";
  const auto says_mount = HasSubstr("not given: the head is assumed at the origin");
  EXPECT_THAT(mapped.out, says_mount);
  const Outcome mounted = here.call(
      {"map", "dive.csv", "--nav", "nav.csv", "--nav-offset", "128", "--mount", "0,0,0,0,0,0", "-o", "mounted.ot"});
  EXPECT_THAT(mounted.out, testing::Not(says_mount));
  const Outcome same = here.call({"compare", "poses.ot", "nav.ot"});
  EXPECT_EQ(same.status, 0) << same.out;

  // Written as poses, it is a trajectory as any.
  const Outcome written = here.call({"convert", "nav.csv", "-o", "nav.tum"});
  EXPECT_EQ(written.status, 0) << written.err;
  EXPECT_THAT(here.call({"info", "nav.tum", "--json"}).out, HasSubstr("\"kind\": \"trajectory\""));
}

TEST(Nav, TellsHowFastSoundIs) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "dive.csv", "--trajectory", "loop", "--turns", "2"}).status, 0);
  const std::string nav = nav_of_poses(here.read("dive.tum"), 0.0);
  here.write("dry.csv", nav);
  here.write("nav.csv", nav + "1,hull,temperature,30,,\n1,bar,temperature,8.7,,\n1,bar,depth,12,,\n");
  const Outcome mapped = here.call({"map", "dive.csv", "--nav", "nav.csv", "--water", "nav,0", "-o", "nav.ot"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("8.7 degrees C at 12.0 m by --nav, salinity 0: sound 1442.2 m/s\n"));
  ASSERT_EQ(here.call({"map", "dive.csv", "--nav", "nav.csv", "--water", "8.7,0,12", "-o", "same.ot"}).status, 0);
  EXPECT_EQ(here.call({"compare", "nav.ot", "same.ot"}).status, 0);
  ASSERT_EQ(here.call({"map", "dive.csv", "--nav", "nav.csv", "-o", "usual.ot"}).status, 0);
  EXPECT_EQ(here.call({"compare", "nav.ot", "usual.ot"}).status, 1) << "ranges are 4% shorter";

  expect_error(here.call({"map", "dive.csv", "--nav", "dry.csv", "--water", "nav,0", "-o", "o.ot"}), 1,
               {"--water", "no temperature"});
  expect_error(here.call({"map", "dive.csv", "--water", "nav,0", "-o", "o.ot"}), 2, {"--water", "--nav"});
  expect_error(here.call({"render", "dive.csv", "--water", "nav,0", "-o", "o.png"}), 2, {"--water", "--nav"});
  expect_error(here.call({"map", "dive.csv", "--nav", "nav.csv", "--water", "nav,90", "-o", "o.ot"}), 2, {"salinity"});
}

// Kills a command that takes the option and goes on with 1500 m/s.
TEST(Nav, TellsEachCommandHowFastSoundIs) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "dive.csv", "--trajectory", "loop", "--turns", "3", "--nav", "n.csv",
                       "--nav-delay", "0"})
                .status,
            0);
  std::istringstream lines(here.read("n.csv"));
  std::string dry;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("depth") == std::string::npos) dry += line + "\n";
  }
  here.write("dry.csv", dry);
  here.write("nav.csv", dry + "1,CTD,temperature,8.7,,,,,,1\n");
  ASSERT_EQ(here.call({"map", "dive.csv", "--poses", "dive.tum", "-o", "tank.bt"}).status, 0);
  const std::vector<std::vector<std::string>> commands = {
      {"slam", "-o", "made"},
      {"slam", "-o", "o.tum", "--matching", "none", "--map", "made.ot"},
      {"locate", "--start", "0,0,0", "--map", "tank.bt", "-o", "made"},
      {"render", "--view", "above", "-o", "made.png"},
      {"render", "--view", "above", "--beside", "--view polar", "-o", "made.png"}};
  for (std::vector<std::string> words : commands) {
    SCOPED_TRACE(words[0] + " ... " + words.back());
    words.insert(words.begin() + 1, {"dive.csv", "--nav", "nav.csv", "--nav-offset", "0"});
    const auto output = [&](std::vector<std::string> more) {
      more.insert(more.begin(), words.begin(), words.end());
      const Outcome made = here.call(more);
      EXPECT_EQ(made.status, 0) << made.err;
      return here.read(words.back());
    };
    const std::string by_nav = output({"--water", "nav,0"});
    EXPECT_TRUE(by_nav == output({"--water", "8.7,0"}));
    EXPECT_FALSE(by_nav == output({}));
  }
  for (const char* command : {"slam", "locate"}) {
    std::vector<std::string> words = {command, "dive.csv", "--nav", "nav.csv", "--water", "nav,0", "-o", "t.tum"};
    if (words[0] == "locate") words.insert(words.end(), {"--map", "tank.bt"});
    EXPECT_THAT(here.call(words).out, HasSubstr("8.7 degrees C at 0.0 m by --nav")) << command;
    words[3] = "dry.csv";
    expect_error(here.call(words), 1, {"--water", "no temperature"});
  }
}

// Kills readers that take the last file alone, or sources of the same name for two.
TEST(Nav, SeveralLogsOfADiveAreOne) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "dive.csv", "--trajectory", "loop", "--turns", "2"}).status, 0);
  const std::string nav = nav_of_poses(here.read("dive.tum"), 0.0);
  const std::string head = nav.substr(0, nav.find('\n') + 1);
  std::string attitude = head, early = head, late = head;
  std::istringstream lines(nav.substr(head.size()));
  int positions = 0;
  for (std::string line; std::getline(lines, line);) {
    std::string& file = line.find("attitude") != std::string::npos ? attitude : ++positions < 30 ? early : late;
    file += line + "\n";
  }
  ASSERT_GT(positions, 60);
  here.write("nav.csv", nav);
  here.write("attitude.csv", attitude);
  here.write("early.csv", early);
  here.write("late.csv", late);
  ASSERT_EQ(here.call({"map", "dive.csv", "--nav", "nav.csv", "-o", "one.ot"}).status, 0);
  const Outcome mapped = here.call(
      {"map", "dive.csv", "--nav", "late.csv", "--nav", "attitude.csv", "--nav", "early.csv", "-o", "several.ot"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_EQ(mapped.err, "");
  EXPECT_EQ(here.call({"compare", "one.ot", "several.ot"}).status, 0);
  expect_error(here.call({"map", "dive.csv", "--nav", "early.csv", "--nav", "late.csv", "-o", "o.ot"}), 1,
               {"early.csv, late.csv", "no valid attitude"});
}

// Kills two dives that are merged as one because the clock of the device began at 0 in both.
TEST(Nav, TwoStartsOfADeviceAreNotOneDive) {
  const Workplace here;
  here.simulate_tank();
  const auto nav_from = [](double begin_s, const char* clock) {
    std::string nav = fmt::format("# clock: {}\ntime_s,source,quantity,x,y,z\n", clock);
    for (int i = 0; i < 40; ++i) {
      nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},dvl,position,0,0,0\n", begin_s + i * 0.5);
    }
    return nav;
  };
  here.write("first.csv", nav_from(0.0, "boot"));
  here.write("second.csv", nav_from(5.0, "boot"));
  here.write("later.csv", nav_from(20.0, "boot"));
  here.write("unix.csv", nav_from(0.0, "unix"));
  here.write("again.csv", nav_from(5.0, "unix"));
  const auto map = [&](const char* one, const char* other) {
    return here.call({"map", "tank.csv", "-o", "o.bt", "--nav", one, "--nav", other, "--nav-offset", "0"});
  };
  expect_error(map("first.csv", "second.csv"), 1,
               {"second.csv: its times count from another start of the device than those of first.csv"});
  const Outcome parts = map("first.csv", "later.csv"), twice = map("unix.csv", "again.csv");
  EXPECT_EQ(parts.status, 0) << parts.err;
  EXPECT_EQ(twice.status, 0) << twice.err;
}

TEST(Nav, WithoutAPositionAVelocityGivesDeadReckoning) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "dive.csv", "--turns", "2"}).status, 0);
  // A quarter of a metre a second to the north, at the depth of 101,325 + 2 x 1025 x 9.80665 Pa.
  std::string nav = "time_s,source,quantity,x,y,z\n";
  for (int i = 0; i <= 100; ++i) {
    nav += fmt::format("{0},ahrs,attitude,0,0,{1}\n{0},dvl,velocity,0.25,0,0\n{0},bar,pressure,121428.63,,\n", i * 0.25,
                       std::numbers::pi / 2.0);
  }
  here.write("nav.csv", nav);
  const Outcome mapped = here.call({"map", "dive.csv", "--nav", "nav.csv", "-o", "map.bt", "--json"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr(R"("nav": {"attitude": "ahrs", "position": "", "poses": 101)"));
  EXPECT_THAT(mapped.out, HasSubstr(R"("velocity": "dvl", "clock": )"));
  EXPECT_THAT(here.call({"map", "dive.csv", "--nav", "nav.csv", "-o", "map.bt"}).out,
              HasSubstr("ahrs and dead reckoning by dvl"));
  const Outcome render = here.call({"render", "dive.csv", "--view", "above", "--nav", "nav.csv", "-o", "map.png"});
  EXPECT_EQ(render.status, 0) << render.err;
}

/// A path to the north in degrees where radians are meant.
std::string nav_in_degrees() {
  std::string nav = "# clock: unix\ntime_s,source,quantity,x,y,z\n";
  for (int i = 0; i < 100; ++i) {
    nav += fmt::format("{0},GPS,fix,{1},10.1,0\n{0},AHRS,attitude,0,0,{2}\n", 0.5 * i, 54.3 + 1e-6 * i, 90 + i);
  }
  return nav;
}

// A vehicle at latitude 54 rad was mapped where it never was, along a path that turned wildly.
TEST(Nav, InDegreesIsRefusedByName) {
  const Workplace here;
  here.simulate_tank();
  here.write("nav.csv", nav_in_degrees());
  const std::string latitude = "the fix of GPS cannot be used: latitude of 54.3 rad is beyond pi/2: is it in degrees?",
                    yaw = "the attitude of AHRS cannot be used: yaw of 90 rad is beyond 2 pi: is it in degrees";
  expect_error(here.call({"map", "tank.csv", "--nav", "nav.csv", "-o", "o.bt"}), 1, {"nav.csv", latitude, yaw});
  expect_error(here.call({"convert", "nav.csv", "-o", "o.tum"}), 1, {"nav.csv", yaw});
  expect_error(here.call({"slam", "tank.csv", "--nav", "nav.csv", "--nav-offset", "0", "-o", "o.tum"}), 1, {yaw});
  const Outcome info = here.call({"info", "nav.csv"}), json = here.call({"info", "nav.csv", "--json"});
  EXPECT_THAT(info.out, HasSubstr("not used    fix of GPS: latitude of 54.3 rad is beyond pi/2: is it in degrees?"));
  EXPECT_THAT(json.out, HasSubstr(R"("fault": "latitude of 54.3 rad is beyond pi/2: is it in degrees?")"));
}

TEST(Nav, ASourceThatIsNotUsedIsNamedBesideAnother) {
  const Workplace here;
  here.simulate_tank();
  std::string nav = "time_s,source,quantity,x,y,z\n";
  for (int i = 0; i < 400; ++i) {
    nav += fmt::format("{0},dvl,position,0,0,0\n{0},imu,attitude,0,0,1\n{0},ahrs,attitude,0,0,{1}\n", 0.5 * i, 90 + i);
  }
  here.write("nav.csv", nav);
  const Outcome mapped = here.call({"map", "tank.csv", "--nav", "nav.csv", "--nav-offset", "0", "-o", "o.bt"});
  EXPECT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("imu and dvl"));
  EXPECT_THAT(mapped.err, HasSubstr("nav.csv: the attitude of ahrs cannot be used: yaw of 90 rad"));
}

// Kills a heading that is integrated from degrees: SLAM was 5 m off and stated 0.1 m.
TEST(Nav, TurnRatesInDegreesPerSecondAreRefusedBySlam) {
  const Workplace here;
  here.simulate_tank();
  std::string nav = "time_s,source,quantity,x,y,z\n";
  for (int i = 0; i < 500; ++i) {
    nav += fmt::format("{0},dvl,velocity,0.2,0,0\n{0},imu,turn rate,0.1,0,{1}\n", 0.2 * i, 8.0 * std::sin(0.1 * i));
  }
  here.write("nav.csv", nav);
  expect_error(here.call({"slam", "tank.csv", "--nav", "nav.csv", "--nav-offset", "0", "-o", "o.tum"}), 1,
               {"the turn rate of imu cannot be used", "is it in degrees per second?"});
}

TEST(Nav, InfoSaysInWhichUnitAPressureWasRead) {
  const Workplace here;
  std::string nav = "time_s,source,quantity,x\n";
  for (int i = 0; i < 100; ++i) nav += fmt::format("{},bar,pressure,{}\n", i, 101.3 + 0.5 * i);
  here.write("nav.csv", nav);
  EXPECT_THAT(here.call({"info", "nav.csv"}).out, HasSubstr("note        bar: read as kPa"));
  EXPECT_THAT(here.call({"info", "nav.csv", "--json"}).out, HasSubstr(R"("note": "read as kPa")"));
}

// Kills a unit that only `info` tells.
TEST(Nav, MapSaysInWhichUnitAPressureWasRead) {
  const Workplace here;
  here.simulate_tank();
  std::string nav = "time_s,source,quantity,x,y,z\n";
  for (int i = 0; i <= 400; ++i) {
    nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},dvl,velocity,0.05,0,0\n{0},bar,pressure,{1},,\n", 0.5 * i,
                       101.3 + 0.05 * i);
  }
  here.write("nav.csv", nav);
  const Outcome mapped = here.call({"map", "tank.csv", "--nav", "nav.csv", "--nav-offset", "0", "-o", "o.bt"});
  EXPECT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.err, HasSubstr("nav.csv: pressure of bar: read as kPa"));
}

// The log of a moving vehicle was mapped as if it stood still, and nothing said so.
TEST(Nav, BesideALogThatIsMappedWithoutIsNamed) {
  const Workplace here;
  here.simulate_tank();
  Outcome mapped = here.call({"map", "tank.csv", "-o", "o.bt"});
  EXPECT_THAT(mapped.out, HasSubstr("vehicle     stands still: no --poses, no --nav\n"));
  EXPECT_THAT(mapped.err, Not(HasSubstr("--nav")));
  here.write("tank.tlog", "of the autopilot");
  here.write("tank.jsonl", "of the DVL");
  mapped = here.call({"map", "tank.csv", "-o", "o.bt"});
  EXPECT_THAT(mapped.err, HasSubstr("mapped as if the vehicle did not move; its navigation may be --nav tank.tlog "
                                    "--nav tank.jsonl"));
}

TEST(Nav, ThatTellsNoPathIsRefusedBeforeItsClock) {
  const Workplace here;
  here.simulate_tank();
  here.write("heading.csv", "time_s,source,quantity,x,y,z\n900,IMU,attitude,0,0,0\n901,IMU,attitude,0,0,0.1\n");
  expect_error(here.call({"map", "tank.csv", "-o", "o.bt", "--nav", "heading.csv"}), 1,
               {"heading.csv: gives no path: it has no valid position or velocity", "pingvox slam"});
  here.write("dvl.csv", "time_s,source,quantity,x,y,z\n0,DVL,velocity,0.1,0,0\n1,DVL,velocity,0.1,0,0\n");
  expect_error(here.call({"convert", "dvl.csv", "-o", "o.tum"}), 1,
               {"dvl.csv", "no valid position", "slam --matching none"});
  expect_error(here.call({"map", "tank.csv", "-o", "o.bt", "--nav", "tank.csv"}), 1,
               {"tank.csv: is a log of beams (.csv), not a navigation log"});
  expect_error(here.call({"map", "tank.csv", "-o", "o.bt", "--poses", "dvl.csv"}), 1,
               {"dvl.csv", "give it with --nav"});
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "tank.bt"}).status, 0);
  expect_error(here.call({"compare", "tank.bt", "tank.bt", "--visible-from", "dvl.csv"}), 2,
               {"dvl.csv", "'pingvox convert' makes one"});
}

// Kills an empty table that looks like a conversion, and "1 damaged records".
TEST(Nav, AConversionSaysWhatItLacks) {
  const Workplace here;
  here.write("remote.txt", "$USRTH,20.0,-20.0,30.0,14.8,49.3,40.7,28.3,-0.3,1.7,29.5,60.5,72*51\n");
  expect_error(here.call({"convert", "remote.txt", "-o", "z.csv"}), 1,
               {"remote.txt: has no samples of navigation in 1 record, 0 damaged"});
  EXPECT_FALSE(std::filesystem::exists(here.path("z.csv")));
  const Outcome info = here.call({"info", "remote.txt"});
  EXPECT_THAT(info.out, HasSubstr("samples     none: no record is of a supported kind"));
  EXPECT_THAT(info.out, Not(HasSubstr("rate Hz")));
  here.write("one.csv", "time_s,source,quantity,x,y,z\n0,DVL,velocity,0.1,0,0\n1,DVL,velocity,0.1,0\n");
  EXPECT_THAT(here.call({"convert", "one.csv", "-o", "z.csv"}).out, HasSubstr("; 1 damaged record skipped\n"));
}

TEST(Nav, ReportsTheFixAtTheOriginOfTheMap) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "dive.csv", "--turns", "1"}).status, 0);
  std::string nav = "time_s,source,quantity,x,y,z\n";
  for (int i = 0; i <= 40; ++i) nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},gps,fix,0.9,-0.3,0\n", i * 0.25);
  here.write("nav.csv", nav);
  const Outcome mapped = here.call({"map", "dive.csv", "--nav", "nav.csv", "-o", "map.bt"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("x east, y north of latitude 51.5662016, longitude -17.1887339 degrees\n"));
}

TEST(Nav, SkipsBeamsWithoutAPoseAndSaysHow) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "dive.csv", "--turns", "2"}).status, 0);
  // A vehicle that is silent from 4 s to 12 s.
  std::string nav = "time_s,source,quantity,x,y,z\n";
  for (int i = 0; i <= 80; ++i) {
    if (i > 16 && i < 48) continue;
    nav += fmt::format("{0},ahrs,attitude,0,0,0\n{0},dvl,position,0,0,0\n", i * 0.25);
  }
  here.write("nav.csv", nav + "21,dvl,position\n");
  const Outcome mapped = here.call({"map", "dive.csv", "--nav", "nav.csv", "-o", "map.bt"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("ahrs and dvl, 1 gap; skipped 1 damaged record\n"));
  EXPECT_THAT(mapped.out, HasSubstr("  frame       origin and axes are those of dvl\n"));
  EXPECT_THAT(mapped.err, HasSubstr("or in one of their gaps, the first at 4.0"));
  EXPECT_THAT(mapped.err, HasSubstr("--nav-offset"));

  const auto map = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"map", "dive.csv", "-o", "map.bt"};
    words.insert(words.end(), more.begin(), more.end());
    return here.call(words);
  };
  expect_error(map({"--nav", "nav.csv", "--nav-offset", "-900"}), 1, {"nothing could be mapped", "--nav-offset"});
  expect_error(map({"--nav", "nav.csv", "--strict"}), 1, {"nav.csv", "line that is not a sample"});
  expect_error(map({"--nav", "nav.csv", "--poses", "a.tum"}), 2, {"--poses and --nav"});
  expect_error(map({"--nav-offset", "3"}), 2, {"--nav-offset"});
  expect_error(map({"--nav", "dive.csv"}), 1, {"dive.csv", "not a navigation log"});
  here.write("sky.csv", "time_s,source,quantity,x,y,z\n1,ahrs,attitude,0,0,0\n");
  expect_error(map({"--nav", "sky.csv"}), 1, {"sky.csv", "no valid position"});
  expect_error(here.call({"convert", "sky.csv", "-o", "sky.tum"}), 1, {"sky.csv", "no valid position"});
}

}  // namespace
}  // namespace pingvox::test
