// 'map' of many dives with navigation of their own.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// 2023-11-14 22:13:20 UTC.
constexpr double kFirstDive_s = 1.7e9;

/// The log of a tank again, with other times.
std::string later_log(const std::string& log, double seconds) {
  std::string text;
  std::size_t line = 0;
  for (std::size_t at = 0; at < log.size(); ++line) {
    const std::size_t end = log.find('\n', at);
    const std::string row = log.substr(at, end - at);
    const std::size_t comma = row.find(',');
    text += line == 0 ? row : fmt::format("{:.6f}{}", std::stod(row.substr(0, comma)) + seconds, row.substr(comma));
    text += '\n';
    at = end + 1;
  }
  return text;
}

/// A vehicle that moves slowly north from 10 degrees east, and begins `east_m` further.
std::string nav_of_dive(double from_s, double to_s, double east_m, bool has_fixes = true) {
  std::string nav = "# clock: unix\ntime_s,source,quantity,x,y,z\n";
  for (double time_s = from_s; time_s <= to_s; time_s += 0.5) {
    const double north_m = 0.01 * (time_s - from_s);
    nav += fmt::format("{:.3f},ahrs,attitude,0,0,0\n", time_s);
    nav += has_fixes ? fmt::format("{:.3f},gps,fix,{:.12f},{:.12f},0\n", time_s, 0.9 + north_m / 6.37e6,
                                   0.17 + east_m / 3.97e6)
                     : fmt::format("{:.3f},dvl,position,{:.3f},{:.3f},0\n", time_s, east_m, north_m);
  }
  return nav;
}

/// Dives of half a minute, one every two minutes.
void write_dives(const Workplace& here, int count) {
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "tank.csv", "--turns", "3"}).status, 0);
  fs::create_directories(here.path("sonar/monday"));
  fs::create_directories(here.path("nav"));
  for (int i = 0; i < count; ++i) {
    const double start_s = kFirstDive_s + 120.0 * i;
    here.write(fmt::format("sonar/monday/dive{}.csv", i), later_log(here.read("tank.csv"), start_s));
    here.write(fmt::format("nav/nav{}.csv", i), nav_of_dive(start_s - 5.0, start_s + 60.0, 0.8 * i));
  }
}

/// Dives in a report as JSON.
std::size_t dives_in(const Outcome& outcome) {
  std::size_t count = 0;
  for (std::size_t at = outcome.out.find("{\"log\":"); at != std::string::npos; ++count) {
    at = outcome.out.find("{\"log\":", at + 1);
  }
  return count;
}

const std::vector<std::string> kMap = {"map", "sonar", "--nav", "nav", "--resolution", "0.1", "-o"};
std::vector<std::string> map_to(const std::string& output, std::vector<std::string> more = {}) {
  std::vector<std::string> words = kMap;
  words.push_back(output);
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(MapOfManyDives, IsTheSumOfTheMapsOfEach) {
  const Workplace here;
  write_dives(here, 3);
  const Outcome all = here.call(map_to("all.pvx", {"--json"}));
  ASSERT_EQ(all.status, 0) << all.err;
  EXPECT_THAT(all.err, HasSubstr("3 of 3: sonar/monday/dive2.csv: "));
  EXPECT_EQ(dives_in(all), 3U) << all.out;
  EXPECT_THAT(all.out, HasSubstr(R"({"log": "sonar/monday/dive1.csv", "nav": ["nav/nav1.csv"], "beams": )"));
  const auto json = flat_json(all.out);
  ASSERT_TRUE(json);
  EXPECT_NEAR(std::stod(json->at("origin.latitude_deg")), 0.9 / 3.14159265 * 180.0, 1e-5);
  const Outcome each = here.call(map_to("each/"));
  ASSERT_EQ(each.status, 0) << each.err;
  EXPECT_THAT(each.out, HasSubstr("3 of 3 logs"));
  ASSERT_EQ(here.call({"merge", "each/monday_dive0.csv.pvx", "each/monday_dive1.csv.pvx", "each/monday_dive2.csv.pvx",
                       "-o", "merged.pvx"})
                .status,
            0);
  EXPECT_EQ(here.call({"compare", "all.pvx", "merged.pvx"}).status, 0);
  // The first is in the frame of its own navigation.
  ASSERT_EQ(
      here.call({"map", "sonar/monday/dive0.csv", "--nav", "nav/nav0.csv", "--resolution", "0.1", "-o", "first.pvx"})
          .status,
      0);
  EXPECT_EQ(here.call({"compare", "first.pvx", "each/monday_dive0.csv.pvx"}).status, 0);
}

TEST(MapOfManyDives, GoesOnWhereItWasKilled) {
  const Workplace here;
  write_dives(here, 5);
  ASSERT_EQ(here.call(map_to("all.ot")).status, 0);
  const std::string in_one_go = here.read("all.ot");
  for (int kept = 0; kept < 5; ++kept) {
    for (int i = kept; i < 5; ++i) fs::remove(here.path(fmt::format("all.ot.dives/monday_dive{}.csv.pvx", i)));
    fs::remove(here.path("all.ot"));
    const Outcome again = here.call(map_to("all.ot"));
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(here.read("all.ot"), in_one_go) << kept;
    EXPECT_THAT(again.out, HasSubstr(fmt::format("maps of {} were made before", kept)));
  }
  // Killed at any time: what is there is whole.
  fs::remove_all(here.path("all.ot.dives"));
  fs::remove(here.path("all.ot"));
  const pid_t child = here.start(map_to("all.ot"));
  while (!here.has("all.ot.dives/monday_dive1.csv.pvx") && !here.has("all.ot")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ::kill(child, SIGKILL);
  status_of(child);
  const Outcome resumed = here.call(map_to("all.ot", {"--quiet"}));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(resumed.err, "");
  EXPECT_EQ(here.read("all.ot"), in_one_go);
}

TEST(MapOfManyDives, MakesAgainWhatOptionsOrFilesChange) {
  const Workplace here;
  write_dives(here, 2);
  const auto made_before = [&](const std::vector<std::string>& more) {
    const Outcome mapped = here.call(map_to("all.bt", more));
    EXPECT_EQ(mapped.status, 0) << mapped.err;
    const std::size_t at = mapped.out.find("maps of ");
    return at == std::string::npos ? std::string() : mapped.out.substr(at, 9);
  };
  EXPECT_EQ(made_before({}), "maps of 0");
  EXPECT_EQ(made_before({}), "maps of 2");
  EXPECT_EQ(made_before({"--threads", "2", "--progress", "never"}), "maps of 2") << "these change no map";
  EXPECT_EQ(made_before({"--max-range", "2"}), "maps of 0");
  EXPECT_EQ(made_before({}), "maps of 0");
  here.write("options.toml", "max_range = 2.5\n");
  EXPECT_EQ(made_before({"--config", "options.toml"}), "maps of 0");
  EXPECT_EQ(made_before({"--config", "options.toml"}), "maps of 2");
  here.write("options.toml", "max_range = 1.75\n");
  EXPECT_EQ(made_before({"--config", "options.toml"}), "maps of 0");
  here.write("nav/nav1.csv", here.read("nav/nav1.csv") + "\n");
  EXPECT_EQ(made_before({"--config", "options.toml"}), "maps of 1");
}

TEST(MapOfManyDives, NamesWhatIsLeftOutAndMapsTheRest) {
  const Workplace here;
  write_dives(here, 2);
  here.write("sonar/lonely.csv", later_log(here.read("tank.csv"), kFirstDive_s + 1e6));
  here.write("sonar/damaged.csv", "time_s,bearing_rad,bin_length_m,intensities\nno,numbers,at,all\n");
  here.write("sonar/empty.bin", "");
  here.write("nav/unused.csv", nav_of_dive(kFirstDive_s - 5e5, kFirstDive_s - 4e5, 0.0));
  const Outcome mapped = here.call(map_to("all.bt"));
  EXPECT_EQ(mapped.status, 1) << mapped.err;
  EXPECT_TRUE(here.has("all.bt"));
  EXPECT_THAT(mapped.err, HasSubstr("sonar/lonely.csv: skipped: has no navigation at its time: of nav/nav1.csv"));
  EXPECT_THAT(mapped.err, HasSubstr("sonar/damaged.csv: skipped: "));
  EXPECT_THAT(mapped.err, HasSubstr("sonar/empty.bin"));
  EXPECT_THAT(mapped.out, HasSubstr("mount"));
  EXPECT_THAT(here.call(map_to("all.bt", {"--json", "--mount", "0,0,0,0,0,0"})).out,
              HasSubstr(R"({"file": "sonar/empty.bin", "reason": "unknown format"})"));
  EXPECT_THAT(mapped.err, HasSubstr("nav/unused.csv: is not used: there is no log at its time"));
  EXPECT_THAT(mapped.out, HasSubstr("2 of 4 logs"));
  // Navigation that no log needs is no failure.
  fs::remove(here.path("sonar/lonely.csv"));
  fs::remove(here.path("sonar/damaged.csv"));
  EXPECT_EQ(here.call(map_to("all.bt")).status, 0);
}

TEST(MapOfManyDives, LeavesOutWhatIsBeyondTheMap) {
  const Workplace here;
  write_dives(here, 1);
  const double start_s = kFirstDive_s + 120.0;
  fs::create_directories(here.path("sonar/tuesday"));
  here.write("sonar/tuesday/far.csv", later_log(here.read("tank.csv"), start_s));
  here.write("nav/far.csv", nav_of_dive(start_s - 5.0, start_s + 60.0, 5000.0));
  const Outcome mapped = here.call(map_to("all.bt"));
  EXPECT_EQ(mapped.status, 1);
  EXPECT_THAT(mapped.err, HasSubstr("far.csv: skipped: nothing could be mapped: "));
  EXPECT_THAT(mapped.err, HasSubstr("outside of the map, which reaches 3.28e+03 m"));
  EXPECT_THAT(mapped.out, HasSubstr("1 of 2 logs"));
  const Outcome deep = here.call(map_to("all.pvx", {"--depth", "20"}));
  EXPECT_EQ(deep.status, 0) << deep.err;
}

TEST(MapOfManyDives, LeavesOutWhatIsNotInTheFrame) {
  const Workplace here;
  write_dives(here, 3);
  here.write("nav/nav1.csv", nav_of_dive(kFirstDive_s + 115.0, kFirstDive_s + 180.0, 0.0, false));
  const Outcome one = here.call(map_to("all.bt", {"--json"}));
  EXPECT_EQ(one.status, 1);
  EXPECT_THAT(one.err, HasSubstr("dive1.csv: skipped: its navigation has no fixes"));
  EXPECT_EQ(dives_in(one), 2U);
  const Outcome each = here.call(map_to("each/", {"--json"}));
  EXPECT_EQ(each.status, 0) << each.err;
  EXPECT_EQ(dives_in(each), 3U);
}

TEST(MapOfManyDives, RefusesWhatItCannotKeep) {
  const Workplace here;
  write_dives(here, 1);
  expect_error(here.call(map_to("-")), 2, {"-o -", "file"});
  expect_error(here.call({"map", "-", "--nav", "nav", "-o", "all.bt"}), 2, {"standard input"});
  expect_error(here.call(map_to("each/", {"--format", "bt"})), 2, {"--format bt", ".pvx"});
  expect_error(here.call(map_to("missing/all.bt")), 1, {"missing"});
  expect_error(here.call(map_to("all.bt", {"--origin", "0,0,0"})), 2, {"--origin"});
  fs::create_directories(here.path("nothing"));
  expect_error(here.call({"map", "nothing", "--nav", "nav", "-o", "all.bt", "--quiet"}), 1,
               {"nothing", "no sonar log"});
  expect_error(here.call({"map", "sonar", "--nav", "nothing", "-o", "all.bt", "--quiet"}), 1,
               {"nothing", "no navigation"});
  here.write("all.bt.dives", "in the way");
  expect_error(here.call(map_to("all.bt")), 1, {"all.bt.dives"});
}

TEST(MapOfManyDives, SaysWhenAFolderCannotBeWritten) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const Workplace here;
  write_dives(here, 1);
  fs::create_directories(here.path("each"));
  fs::permissions(here.path("each"), fs::perms::owner_read | fs::perms::owner_exec);
  const Outcome mapped = here.call(map_to("each/"));
  EXPECT_EQ(mapped.status, 1);
  EXPECT_THAT(mapped.err, HasSubstr("each"));
}

}  // namespace
}  // namespace pingvox::test
