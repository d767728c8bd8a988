// Files that are not what they should be, and places that cannot be written.

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <random>

#include "call.hpp"

namespace pingvox::test {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;
using Words = std::vector<std::string>;

/// A call of each command that reads `file`.
std::vector<Words> readers_of(const std::string& file) {
  return {{"map", file, "-o", "out.bt"},     {"info", file},
          {"info", file, "--json"},          {"convert", file, "-o", "out.csv"},
          {"convert", file, "-o", "out.ot"}, {"render", file, "-o", "out.png"},
          {"compare", file, "good.ot"},      {"compare", "good.ot", file}};
}

/// Commands report trouble with a file by 1, compare by 2.
int trouble(const Words& words) {
  return words.front() == "compare" ? 2 : 1;
}

void make_good_map(const Workplace& here) {
  here.simulate_tank();
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "good.ot", "--quiet"}).status, 0);
}

TEST(Files, WhatCannotBeReadIsOneLineAndNoOutput) {
  const Workplace here;
  make_good_map(here);
  here.write("empty", "");
  here.write("noise", "\x01\x02\xFE\0\xFF no format begins like this"s);
  here.write("prose.txt", "Dear diary,\ntoday the sonar heard nothing.\n");
  here.write("line\nbreak", "");
  fs::create_directory(here.folder() / "folder");
  const auto files_before = here.files();
  std::size_t calls = 0;
  for (const std::string file : {"missing", "empty", "noise", "prose.txt", "folder", "line\nbreak", "missing/file"}) {
    for (const Words& words : readers_of(file)) {
      SCOPED_TRACE(::testing::PrintToString(words));
      const std::string name = file == "line\nbreak" ? "line?break" : file;
      expect_error(here.call(words), trouble(words), {name});
      ++calls;
    }
  }
  EXPECT_EQ(calls, 56U);
  EXPECT_EQ(here.files(), files_before);
}

TEST(Files, TheWrongKindIsNamed) {
  const Workplace here;
  make_good_map(here);
  here.write("poses.txt", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n");
  const auto files_before = here.files();
  expect_error(here.call({"map", "good.ot", "-o", "out.bt"}), 1, {"good.ot", "a map", "not a log"});
  expect_error(here.call({"map", "poses.txt", "-o", "out.bt"}), 1, {"poses.txt", "a trajectory", "not a log"});
  here.write("nav.csv", "time_s,source,quantity,x,y,z\n0,imu,heading,0,,\n1,imu,heading,0,,\n");
  expect_error(here.call({"map", "nav.csv", "-o", "out.bt"}), 1,
               {"nav.csv: is a navigation log (.csv), not a log of a sonar: give it with --nav\n"});
  for (const std::string command : {"map", "slam", "locate"}) {
    Words words = {command, "tank.csv", "-o", command == "map" ? "out.bt" : "out.tum", "--nav", "poses.txt"};
    if (command == "locate") words.insert(words.end(), {"--map", "good.ot"});
    expect_error(here.call(words), 1, {"poses.txt: is a trajectory (.tum), not a navigation log: ", "--poses"});
  }
  fs::remove(here.folder() / "nav.csv");
  expect_error(here.call({"map", "tank.csv", "-o", "out.bt", "--poses", "good.ot"}), 1,
               {"good.ot: is a map (.ot), not a trajectory"});
  expect_error(here.call({"map", "tank.csv", "-o", "out.bt", "--poses", "tank.csv"}), 1,
               {"tank.csv: is a log of beams (.csv), not a trajectory"});
  expect_error(here.call({"simulate", "tank", "-o", "out.csv", "--poses", "tank.csv"}), 1,
               {"tank.csv: is a log of beams (.csv), not a trajectory"});
  expect_error(here.call({"compare", "tank.csv", "good.ot"}), 2, {"tank.csv: is a log of beams (.csv), not a map"});
  expect_error(here.call({"convert", "tank.csv", "-o", "out.bt"}), 2, {"tank.csv", "pingvox map"});
  expect_error(here.call({"convert", "good.ot", "-o", "out.csv"}), 2, {"good.ot", "a map"});
  expect_error(here.call({"render", "poses.txt", "-o", "out.png"}), 1, {"poses.txt", "a trajectory"});
  EXPECT_EQ(here.files(), files_before);
}

TEST(Files, UnknownFilesAreNamedWithWhatToDo) {
  const Workplace here;
  const std::vector<std::pair<std::string, std::vector<std::string>>> unknown_files = {
      {"#ROSBAG V1.2\n", {"ROS bag", "before 2.0", "rosbag fix"}},
      {"\x1f\x8b\x08 tank.csv"s, {"compressed", "unpack"}},
      {"\xff\xfet\0i\0"s, {"UTF-16", "UTF-8"}},
      {"version https://git-lfs.github.com/spec/v1\n", {"git lfs pull"}},
      {"%time,field.header.seq,field.header.stamp,field.depth\n1,2,3,4.5\n", {"rostopic echo -p", "bag"}},
      {"time;angle;range\n1;2;3\n", {"is text of no known format", "the line", "bin_length_m"}},
      {"ping,angle,range\n1,2,3\n", {"'time_s,bearing_cw_deg,", "docs/formats.md"}},
      {"PARAM robot_front_laser_max 81.9 0.1 host 0.1\nFLASER 2 1.0 2.0 0 0 0 0 0 0 0.1 host 0.1\n",
       {"laser scanner by CARMEN", "NODE"}},
      {"# CARMEN Logfile\n\nODOM 0 0 0 0 0 0 0.1 host 0.1\n", {"CARMEN", ".xyz"}},
      {"\xa3\x95\x46 the records of a full memory"s, {"DataFlash", "FMT", ".tlog"}},
      {"\xfe\x09\x00\x01\x01\x00\x00\x00\x00\x00\x0c\x03\x51\x04\x03\xdf\xe4"s,
       {"MAVLink without the time", ".tlog"}},  // a HEARTBEAT
      // Taken for counter-clockwise, a map would be its mirror image.
      {"\x7b\x01\0\0 a multibeam's"s, {"is not a log, cloud, map", "clockwise from ahead", "bearing_deg is counter"}},
  };
  for (const auto& [content, texts] : unknown_files) {
    SCOPED_TRACE(texts.front());
    here.write("unknown", content);
    expect_error(here.call({"info", "unknown"}), 1, texts);
    expect_error(here.call({"map", "unknown", "-o", "out.bt"}), 1, texts);
  }
}

TEST(Files, OutputFormatsAreNamedAsSuch) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "tank.csv", "--turns", "1", "--truth", "truth", "--resolution", "0.2",
                       "--quiet"})
                .status,
            0);
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "tank.bt", "--resolution", "0.2", "--quiet"}).status, 0);
  ASSERT_EQ(here.call({"convert", "tank.bt", "-o", "grid.yaml", "--quiet"}).status, 0);
  ASSERT_EQ(here.call({"convert", "tank.bt", "-o", "tank.asc", "--quiet"}).status, 0);
  for (const char* const file : {"tank.tif", "tank.las", "tank.glb"}) {
    ASSERT_EQ(here.call({"convert", "tank.bt", "-o", file, "--quiet"}).status, 0);
  }
  here.write("dive.tum", "0 0 0 0 0 0 0 1\n");
  ASSERT_EQ(here.call({"convert", "dive.tum", "-o", "dive.geojson", "--origin", "54,10"}).status, 0);
  const std::vector<std::pair<std::string, std::string>> written = {{"tank.tif", "TIFF"},
                                                                    {"tank.las", "LAS"},
                                                                    {"tank.glb", "glTF"},
                                                                    {"dive.geojson", "GeoJSON"},
                                                                    {"grid.yaml", "grid for map_server"},
                                                                    {"grid.pgm", "grid for map_server"},
                                                                    {"tank.asc", "grid of heights"},
                                                                    {"truth/ranges.csv", "true ranges"}};
  for (const auto& [name, what] : written) {
    SCOPED_TRACE(name);
    const Outcome outcome = here.call({"info", name});
    expect_error(outcome, 1, {name, what, "does not read it"});
    EXPECT_EQ(outcome.err.find("bearing_cw_deg"), std::string::npos);
  }
}

TEST(Files, TruncatedMapsAreRefusedAndTruncatedLogsReadAsFarAsTheyGo) {
  const Workplace here;
  make_good_map(here);
  ASSERT_EQ(here.call({"convert", "good.ot", "-o", "good.bt", "--quiet"}).status, 0);
  ASSERT_EQ(here.call({"convert", "good.ot", "-o", "good.pvx", "--quiet"}).status, 0);
  for (const std::string name : {"good.ot", "good.bt", "good.pvx"}) {
    const std::string whole = here.read(name);
    for (const std::size_t size : {std::size_t{10}, whole.size() / 2, whole.size() - 1}) {
      SCOPED_TRACE(name + " cut to " + std::to_string(size));
      here.write("cut", whole.substr(0, size));
      expect_error(here.call({"info", "cut"}), 1, {"cut"});
      expect_error(here.call({"compare", "cut", "good.ot"}), 2, {"cut"});
    }
  }

  const std::string log = here.read("tank.csv");
  const std::size_t line = log.find('\n', log.size() / 2) + 1;
  here.write("cut.csv", log.substr(0, line + 3));
  const Outcome skipped = here.call({"info", "cut.csv", "--json"});
  EXPECT_EQ(skipped.status, 0) << skipped.err;
  EXPECT_THAT(skipped.out, ::testing::HasSubstr("\"skipped\": 1}"));
  expect_error(here.call({"info", "cut.csv", "--strict"}), 1, {"cut.csv", "line"});
  expect_error(here.call({"map", "cut.csv", "-o", "out.bt", "--strict"}), 1, {"cut.csv", "line"});
  EXPECT_FALSE(here.has("out.bt"));
}

TEST(Files, FlippedBytesNeverEndTheProgramOtherwiseThanByAWord) {
  const Workplace here;
  make_good_map(here);
  ASSERT_EQ(here.call({"convert", "good.ot", "-o", "good.bt", "--quiet"}).status, 0);
  std::mt19937_64 random(5);
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(round);
    const std::string name = round % 3 == 0 ? "tank.csv" : (round % 3 == 1 ? "good.ot" : "good.bt");
    std::string bytes = here.read(name);
    for (int i = 0; i < 5; ++i)
      bytes[random() % std::min<std::size_t>(bytes.size(), 3000)] = static_cast<char>(random());
    here.write("mutant", bytes);
    const Outcome outcome = here.call({"info", "mutant", "--json"});
    if (outcome.status == 0) {
      EXPECT_EQ(outcome.err, "");
    } else {
      expect_error(outcome, 1, {"mutant"});
    }
  }
}

TEST(Files, ALogInWhichNothingCanBeMappedIsNoMap) {
  const Workplace here;
  here.simulate_tank();
  here.write("late.txt", "1e6 0 0 0 0 0 0 1\n2e6 1 0 0 0 0 0 1\n");
  expect_error(here.call({"map", "tank.csv", "-o", "out.bt", "--poses", "late.txt"}), 1, {"tank.csv", "poses"});
  expect_error(
      here.call({"map", "tank.csv", "-o", "out.bt", "--resolution", "1e-5", "--beam", "ray"}), 1,
      {"tank.csv: nothing could be mapped: 400 of 400 beams outside of the map", "0.328 m from its origin", "larger"});
  expect_error(here.call({"map", "tank.csv", "-o", "out.bt", "--mount", "1e308,0,0,0,0,0"}), 1,
               {"400 of 400 beams outside of the map"});
  EXPECT_FALSE(here.has("out.bt"));
}

TEST(Files, OneLogInWhichNothingCanBeMappedDoesNotKeepTheOthersOutOfTheMap) {
  const Workplace here;
  here.simulate_tank();
  here.write("empty.csv", "");
  here.write("heading.csv", "time_s,bearing_rad,bin_length_m,intensities\n");
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "alone.pvx"}).status, 0);
  const Outcome outcome = here.call({"map", "empty.csv", "tank.csv", "heading.csv", "-o", "all.pvx"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("empty.csv: is empty"));
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("heading.csv: nothing could be mapped: it is empty"));
  EXPECT_EQ(here.call({"compare", "all.pvx", "alone.pvx"}).status, 0);
  expect_error(here.call({"map", "empty.csv", "heading.csv", "-o", "none.bt"}), 1, {"empty.csv: is empty"});
  EXPECT_FALSE(here.has("none.bt"));
}

// These would be read until memory is full.
TEST(Files, APipeWithoutEndThatIsNoLogIsRefusedByItsBeginning) {
  const Workplace here;
  for (const std::string device : {"/dev/zero", "/dev/urandom"}) {
    expect_error(here.call({"info", device}), 1, {device, "is not a log, cloud, map"});
    expect_error(here.call({"map", device, "-o", "o.bt"}), 1, {device, "is not a log, cloud, map"});
  }
}

// One line on standard error, and all else as of any map.
TEST(Map, ThatKnowsNothingSaysWhy) {
  const Workplace here;
  here.simulate_tank();
  std::vector<std::string> words = {"map", "tank.csv", "-o", "out.bt", "--min-range", "100"};
  const Outcome outcome = here.call(words);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("nothing is known"));
  EXPECT_THAT(outcome.err, ::testing::StartsWith("pingvox: "));
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("the map is empty: no echoes and no free space"));
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("--min-range"));
  words.push_back("--quiet");
  EXPECT_EQ(here.call(words).err, "");
  EXPECT_EQ(here.call({"map", "tank.csv", "-o", "out.bt"}).err, "");
}

TEST(Map, BeamsOutsideOfItAreCalledThat) {
  const Workplace here;
  here.write("a.txt", "NODE 0 0 0 0 0 0\n1 0 0\n1e6 0 0\nx\n");
  const Outcome outcome = here.call({"map", "a.txt", "-o", "a.bt"});
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("; 2 skipped\n"));
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("a.txt: skipped 1 of 2 points outside of the map"));
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("; 1 damaged record, the first: line 4: is not a point"));
}

// A cloud in UTM took 18 s and 4 GB, or its refusal advised a coarser map.
TEST(Map, ACloudFarFromWhereItWasSeenNamesTheOrigin) {
  const Workplace here;
  std::string points;
  for (int i = 0; i < 200; ++i) points += fmt::format("{} {} -20\n", 500000 + 0.05 * i, 4100000 + 0.03 * i);
  here.write("utm.xyz", points);
  const std::string origin = "seen from 0, 0, 0, 4130 km away: --origin is where a cloud was seen from";
  expect_error(here.call({"map", "utm.xyz", "-o", "m.bt"}), 1, {"utm.xyz: ", origin, "--depth 32"});
  expect_error(here.call({"map", "utm.xyz", "--depth", "32", "-o", "m.pvx"}), 1,
               {"utm.xyz: its points are " + origin, "and 1e+06 are the most"});
  const Outcome given = here.call({"map", "utm.xyz", "--depth", "32", "--origin", "500000,4100000,0", "-o", "m.pvx"});
  ASSERT_EQ(given.status, 0) << given.err;
  EXPECT_THAT(given.out, ::testing::HasSubstr("200 points in 1 scan"));
  EXPECT_EQ(given.err, "");
  // Rays that fit into the memory are mapped, with a word.
  const Outcome coarse = here.call({"map", "utm.xyz", "--depth", "32", "--resolution", "20", "-o", "m.pvx"});
  ASSERT_EQ(coarse.status, 0) << coarse.err;
  EXPECT_THAT(coarse.err, ::testing::HasSubstr("utm.xyz: its points are " + origin));
}

TEST(Map, RaysOfTooManyCellsAreRefusedAtOnce) {
  const Workplace here;
  here.simulate_tank();
  for (const char* shape : {"ray", "cone"}) {
    expect_error(
        here.call({"map", "tank.csv", "--beam", shape, "--resolution", "1e-6", "--depth", "32", "-o", "m.pvx"}), 1,
        {"tank.csv: a beam of", "are the most", "larger cells"});
  }
}

TEST(Output, AFailedCallKeepsTheOldFile) {
  const Workplace here;
  here.simulate_tank();
  here.write("out.bt", "old");
  here.write("out.csv", "old");
  here.write("empty", "");
  fs::create_directory(here.folder() / "folder.bt");
  const auto files_before = here.files();

  expect_error(here.call({"map", "empty", "-o", "out.bt"}), 1, {"empty"});
  expect_error(here.call({"map", "tank.csv", "-o", "out.bt", "--memory-limit", "10K"}), 1, {"limit"});
  expect_error(here.call({"map", "tank.csv", "-o", "no/such/folder/out.bt"}), 1, {"no/such/folder"});
  expect_error(here.call({"map", "tank.csv", "-o", "folder.bt"}), 1, {"folder.bt"});
  // A disk that is full in the middle of the file.
  expect_error(here.call({"map", "tank.csv", "-o", "out.bt"}, {.file_bytes = 500}), 1, {"out.bt"});
  expect_error(here.call({"convert", "tank.csv", "-o", "out.csv"}, {.file_bytes = 50'000}), 1, {"out.csv"});
  EXPECT_EQ(here.read("out.bt"), "old");
  EXPECT_EQ(here.read("out.csv"), "old");
  EXPECT_EQ(here.files(), files_before);
}

// Kills an hour of mapping for a place that could not be written from the start.
// A command that wrote over its own input, or one output over another, ended with 0.
TEST(Output, IsNeverAnInputOrAnotherOutputOfTheSameCommand) {
  const Workplace here;
  const std::string kept = "# never to be lost\n";
  for (const char* name :
       {"log.csv", "nav.csv", "c.xyz", "way.tum", "m.bt", "s.toml", "a.png", "dive", "d/poses.tum"}) {
    fs::create_directories((here.folder() / name).parent_path());
    here.write(name, kept);
  }
  for (const char* name : {"h.pgm", "h.yaml", "bag/dive_0.mcap", "bag/metadata.yaml"}) {
    fs::create_directories((here.folder() / name).parent_path());
    here.write(name, kept);
  }
  fs::create_symlink("../not_there.tum", here.folder() / "d/to_nothing.tum");
  here.write("d/fields.toml", "[[beams]]\ntopic = \"/a\"\nangle = \"a\"\nrange = \"r\"\nintensities = \"i\"\n");
  fs::create_symlink("log.csv", here.folder() / "link.csv");
  fs::create_hard_link(here.folder() / "log.csv", here.folder() / "other.csv");
  const auto files_before = here.files();
  const std::vector<std::pair<Words, std::string>> cases = {
      {{"slam", "log.csv", "--nav", "nav.csv", "-o", "nav.csv"}, "-o nav.csv: is the same file as --nav nav.csv"},
      {{"slam", "log.csv", "-o", "./log.csv"}, "-o ./log.csv: is the same file as LOG log.csv"},
      {{"slam", "link.csv", "-o", "log.csv"}, "-o log.csv: is the same file as LOG link.csv"},
      {{"slam", "log.csv", "-o", "other.csv"}, "-o other.csv: is the same file as LOG log.csv"},
      {{"slam", "log.csv", "-o", "s.tum", "--covariance", "log.csv"}, "--covariance log.csv: is the same file as LOG"},
      {{"slam", "log.csv", "-o", "s.tum", "--calibration", "d/../s.tum"}, "--calibration d/../s.tum: is the same file"},
      {{"slam", "log.csv", "-o", "s.tum", "--config", "s.toml", "--calibration", "s.toml"}, "as --config s.toml"},
      {{"locate", "log.csv", "--map", "m.bt", "--odometry", "way.tum", "-o", "way.tum"}, "as --odometry way.tum"},
      {{"map", "c.xyz", "-o", "c.xyz"}, "-o c.xyz: is the same file as LOG c.xyz"},
      {{"map", "log.csv", "--format", "bt", "--poses", "dive", "-o", here.path("dive")}, "as --poses dive"},
      {{"render", "log.csv", "m.bt", "--path", "a.png", "-o", "./a.png"}, "as --path a.png"},
      {{"convert", "log.csv", "-o", "log.csv", "--echoes"}, "-o log.csv: is the same file as IN log.csv"},
      {{"convert", "m.bt", "-o", "m.bt"}, "-o m.bt: is the same file as IN m.bt"},
      {{"convert", "h.pgm", "-o", "h.yaml"}, "the other file of the grid, h.pgm: is the same file as IN h.pgm"},
      {{"convert", "h.yaml", "-o", "./h.pgm"}, "the other file of the grid, ./h.yaml: is the same file as IN h.yaml"},
      {{"convert", "bag", "-o", "bag/dive_0.mcap"}, "-o bag/dive_0.mcap: is a file of IN bag"},
      {{"map", "log.csv", "--fields", "d/fields.toml", "--format", "bt", "-o", "d/fields.toml"},
       "as --fields d/fields.toml"},
      {{"slam", "log.csv", "-o", "not_there.tum", "--covariance", "d/to_nothing.tum"},
       "--covariance d/to_nothing.tum: is the same file as -o not_there.tum"},
      {{"simulate", "tank", "-o", "w.csv", "--nav", "w.csv"}, "--nav w.csv: is the same file as -o w.csv"},
      {{"simulate", "tank", "-o", "w.csv", "--nav", "w.tum", "--trajectory", "loop"},
       "the trajectory beside -o, w.tum"},
      {{"simulate", "tank", "-o", "way.csv", "--poses", "way.tum"}, "as --poses way.tum"},
      {{"simulate", "tank", "-o", "w.csv", "--poses", "d/poses.tum", "--truth", "d"}, "--truth d/poses.tum: is the"},
      {{"live", "replay:dive", "--format", "bt", "-o", "dive"}, "as DEVICE dive"},
      {{"live", "ping360:udp://127.0.0.1:1", "--nav", "mavlink:udp://:14550", "--format", "bt", "-o", "d.tlog",
        "--record", "d.bin"},
       "-o: .tlog is for the recording of --nav"},
      {{"live", "ping360:udp://127.0.0.1:1", "-o", "same.bt", "--record", "same.bt"}, "--record same.bt: is the same"}};
  for (const auto& [words, text] : cases) {
    SCOPED_TRACE(::testing::PrintToString(words));
    expect_error(here.call(words), 2, {words.front() + ": ", text});
    if (::testing::Test::HasFailure()) return;  // a device that is not there is waited for
  }
  EXPECT_EQ(here.files(), files_before);
  for (const std::string& name : files_before) {
    EXPECT_EQ(here.read(name == "d" ? "d/poses.tum" : name == "bag" ? "bag/dive_0.mcap" : name), kept) << name;
  }
  // Devices take any number of outputs, and several commands may share them.
  EXPECT_EQ(here.call({"simulate", "tank", "-o", "/dev/null", "--nav", "/dev/null", "--turns", "1"}).status, 0);
}

TEST(Output, APlaceThatCannotBeWrittenIsSaidBeforeTheWork) {
  const Workplace here;
  fs::create_directory(here.folder() / "folder.bt");
  expect_error(here.call({"map", "missing.csv", "-o", "folder.bt"}), 1, {"folder.bt", "is a folder"});
  expect_error(here.call({"map", "missing.csv", "-o", "no/out.bt"}), 1, {"no such folder 'no'"});
  fs::create_directory(here.folder() / "folder");
  for (const std::string output : {"folder", "folder/", "no/"}) {
    expect_error(here.call({"map", "missing.csv", "-o", output}), 2, {output + ": is a folder", ".bt"});
  }
  expect_error(here.call({"render", "missing.csv", "-o", "folder"}), 2, {"folder: is a folder", ".png"});
}

TEST(Output, AFolderWithoutTheRightToWriteIsNamed) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const Workplace here;
  here.simulate_tank();
  fs::create_directory(here.folder() / "locked");
  fs::permissions(here.folder() / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  expect_error(here.call({"map", "tank.csv", "-o", "locked/out.bt"}), 1, {"locked/out.bt", "ermission"});
}

TEST(Output, AFullDiskOrAReaderThatWentAwayIsOneLine) {
  const Workplace here;
  make_good_map(here);
  const std::vector<Words> calls = {{"map", "tank.csv", "-o", "-"},
                                    {"map", "tank.csv", "-o", "a.bt", "--json"},
                                    {"info", "tank.csv", "--json"},
                                    {"info", "good.ot"},
                                    {"compare", "good.ot", "good.ot"},
                                    {"convert", "tank.csv", "-o", "-"},
                                    {"simulate", "tank", "-o", "-"},
                                    {"--help"},
                                    {"map", "--help"},
                                    {"--version"},
                                    {"render", "good.ot", "-o", "-"}};
  for (const Words& words : calls) {
    SCOPED_TRACE(::testing::PrintToString(words));
    expect_error(here.call(words, {.out_path = "/dev/full"}), trouble(words), {"standard output", "No space"});
    expect_error(here.call(words, {.out_is_broken_pipe = true}), trouble(words), {"standard output", "pipe"});
    expect_error(here.call(words, {.out_is_closed = true}), trouble(words), {"standard output"});
  }
  expect_error(here.call({"map", "tank.csv", "-o", "/dev/full"}), 1, {"/dev/full", "No space"});
}

TEST(Output, KilledWhileWritingLeavesTheOldFile) {
  const Workplace here;
  here.write("log.csv", "old");
  int killed_while_writing = 0;
  for (int attempt = 0; attempt < 20 && killed_while_writing < 3; ++attempt) {
    const pid_t child = here.start({"simulate", "tank", "-o", "log.csv", "--turns", "3000", "--quiet"});
    // Written beside its name: when that file is there and has bytes, the write is on its way.
    bool is_writing = false, has_ended = false;
    while (!is_writing && !has_ended) {
      for (const auto& entry : fs::directory_iterator(here.folder())) {
        std::error_code error;
        if (entry.path().filename() != "log.csv" && entry.file_size(error) > 0 && !error) is_writing = true;
      }
      siginfo_t ended = {};
      has_ended =
          ::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == child;
    }
    ::kill(child, SIGKILL);
    if (status_of(child) == 128 + SIGKILL && is_writing) ++killed_while_writing;
    ASSERT_EQ(here.read("log.csv"), "old");
  }
  EXPECT_EQ(killed_while_writing, 3);
  EXPECT_EQ(here.call({"simulate", "tank", "-o", "log.csv", "--turns", "1", "--quiet"}).status, 0);
  EXPECT_THAT(here.files(), ::testing::ElementsAre("log.csv"));
}

}  // namespace
}  // namespace pingvox::test
