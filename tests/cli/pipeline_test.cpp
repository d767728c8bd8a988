// The commands one after another, and what their JSON promises.

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "call.hpp"
#include "io/internal/json.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

using Args = std::vector<std::string>;

std::vector<std::string> keys_of(const FlatJson& json) {
  std::vector<std::string> keys;
  for (const auto& entry : json) keys.push_back(entry.first);
  return keys;
}

/// The JSON of a call that is done, with exactly these keys.
FlatJson json_with(const Outcome& outcome, const Args& keys) {
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto json = flat_json(outcome.out);
  EXPECT_TRUE(json) << outcome.out;
  if (!json) return {};
  EXPECT_THAT(keys_of(*json), ::testing::UnorderedElementsAreArray(keys));
  return *json;
}

Args map_keys() {
  return {"beams",
          "sweeps",
          "echoes",
          "skipped",
          "cells_freed",
          "cells_hit",
          "skipped_for.damage",
          "skipped_for.no_pose",
          "skipped_for.blocked",
          "skipped_for.too_long",
          "skipped_for.outside_map",
          "sound_speed_m_s",
          "beam.shape",
          "beam.width_deg",
          "beam.height_deg",
          "threshold.min",
          "threshold.max",
          "seconds.read",
          "seconds.detect",
          "seconds.trace",
          "seconds.apply",
          "seconds.write",
          "seconds.total",
          "map.resolution",
          "map.depth",
          "map.leaves",
          "map.inner",
          "map.memory_bytes",
          "map.occupied_cells",
          "map.free_cells",
          "map.bounds.min",
          "coverage.beam_width_m",
          "coverage.pauses.count",
          "coverage.pauses.total_s",
          "coverage.pauses.longest_s",
          "coverage.warnings",
          "coverage.coverage",
          "coverage.moved_m",
          "coverage.places",
          "coverage.places_in_one_sweep",
          "coverage.sweep_s",
          "coverage.sweeps",
          "coverage.sweeps_per_place",
          "coverage.turned_deg",
          "map.bounds.max",
          "resolution_from.range_m",
          "resolution_from.beam_width_deg"};
}

Args info_log_keys() {
  return {"kind",   "format",        "beams",         "sweeps",       "bins.min",       "all_sweeps",
          "echoes", "threshold.min", "threshold.max", "bins.max",     "bin_length_m",   "duration_s",
          "clock",  "sector_deg",    "skipped",       "pauses.count", "pauses.total_s", "pauses.longest_s"};
}

Args info_map_keys() {
  return {"kind",  "format",         "resolution", "depth",      "nodes",      "leaves",
          "inner", "occupied_cells", "free_cells", "bounds.min", "bounds.max", "memory_bytes"};
}

// A sweep that takes long for pauses looked like a slow head.
TEST(Pipeline, InfoCountsPausesOfTheHead) {
  const Workplace here;
  std::string log = "time_s,bearing_cw_deg,bin_length_m,intensities\n";
  double time_s = 100.0;
  for (int beam = 0; beam < 60; ++beam) {
    log += fmt::format("{},{},0.5,1,2,3,200,3\n", time_s, beam * 6);
    time_s += beam % 20 == 19 ? 4.0 : 0.1;
  }
  here.write("a.csv", log);
  const Outcome told = here.call({"info", "a.csv"});
  EXPECT_THAT(told.out, testing::HasSubstr("pauses      2 of 4 s (median), 8 s in all"));
  const auto json = flat_json(here.call({"info", "a.csv", "--json"}).out);
  ASSERT_TRUE(json);
  EXPECT_EQ(json->at("pauses.count"), "2");
  // A head that is slow all the time has none.
  std::string slow = "time_s,bearing_cw_deg,bin_length_m,intensities\n";
  for (int beam = 0; beam < 30; ++beam) slow += fmt::format("{},{},0.5,1,2,3,200,3\n", 2 * beam, beam * 6);
  here.write("b.csv", slow);
  EXPECT_THAT(here.call({"info", "b.csv"}).out, testing::Not(testing::HasSubstr("pauses")));
}

// Lengths that differ by rounding had one key, eight times.
TEST(Pipeline, InfoCountsBinLengthsThatItShowsAlikeAsOne) {
  const Workplace here;
  std::string log = "time_s,bearing_deg,bin_length_m,intensities\n";
  for (int i = 0; i < 30; ++i) log += fmt::format("{},{},{},1,2,3\n", i, i, 0.0252525 + 1e-9 * (i % 10));
  here.write("log.csv", log + "30,30,0.05,1,2,3\n");
  EXPECT_THAT(here.call({"info", "log.csv", "--json"}).out,
              testing::HasSubstr(R"("bin_lengths": {"0.0252525": 30, "0.05": 1})"));
  EXPECT_THAT(here.call({"info", "log.csv"}).out, testing::HasSubstr("0.0252525 m (30 beams), 0.05 m (1 beam)"));
}

TEST(Pipeline, FromTheSimulatedTankToItsPictures) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "tank.csv", "--seed", "3", "--turns", "3"}).status, 0);

  Args keys = info_log_keys();
  keys.insert(keys.end(), {"bin_lengths.0.0125", "late"});
  FlatJson log = json_with(here.call({"info", "tank.csv", "--json"}), keys);
  EXPECT_EQ(log["kind"], "\"log\"");
  EXPECT_EQ(log["format"], "\"csv\"");
  EXPECT_EQ(log["beams"], "600");
  EXPECT_EQ(log["sweeps"], "3");
  EXPECT_EQ(log["bins.min"], "399");
  EXPECT_EQ(log["bins.max"], "399");
  EXPECT_EQ(log["sector_deg"], "360");
  EXPECT_EQ(log["skipped"], "0");

  FlatJson made = json_with(here.call({"map", "tank.csv", "-o", "tank.ot", "--beam", "fan", "--json"}), map_keys());
  EXPECT_EQ(made["beams"], "600");
  EXPECT_EQ(made["sweeps"], "3");
  EXPECT_EQ(made["map.resolution"], "0.05");
  EXPECT_EQ(made["map.depth"], "16");

  FlatJson map = json_with(here.call({"info", "tank.ot", "--json"}), info_map_keys());
  EXPECT_EQ(map["kind"], "\"map\"");
  EXPECT_EQ(map["format"], "\"ot\"");
  EXPECT_EQ(map["occupied_cells"], made["map.occupied_cells"]);
  EXPECT_EQ(map["free_cells"], made["map.free_cells"]);
  EXPECT_EQ(map["bounds.min"], made["map.bounds.min"]);
  EXPECT_NE(map["occupied_cells"], "0");

  for (const std::string name : {"tank.bt", "tank.pvx"}) {
    SCOPED_TRACE(name);
    const Outcome converted = here.call({"convert", "tank.ot", "-o", name});
    EXPECT_EQ(converted.status, 0) << converted.err;
    const Outcome compared = here.call({"compare", "tank.ot", name, "--json"});
    FlatJson found =
        json_with(compared, {"cells", "same", "different", "only_a", "only_b", "max_log_odds_difference",
                             "classes.occupied_a", "classes.occupied_b", "classes.occupied_both", "classes.free_a",
                             "classes.free_b", "classes.free_both", "against_b.precision", "against_b.recall",
                             "against_b.free_true", "against_b.free_true_1_cell"});
    EXPECT_EQ(found["same"], found["cells"]);
    EXPECT_EQ(found["different"], "0");
    EXPECT_EQ(found["only_a"], "0");
    EXPECT_EQ(found["only_b"], "0");
    if (name == "tank.pvx") {
      EXPECT_EQ(found["max_log_odds_difference"], "0");
    }
  }

  EXPECT_EQ(here.call({"convert", "tank.ot", "-o", "tank.ply"}).status, 0);
  EXPECT_TRUE(here.read("tank.ply").starts_with("ply\n"));
  EXPECT_EQ(here.call({"convert", "tank.csv", "-o", "again.csv"}).status, 0);
  EXPECT_EQ(here.read("again.csv"), here.read("tank.csv"));
  for (const std::string name : {"tank.csv", "tank.ot", "tank.bt"}) {
    SCOPED_TRACE(name);
    const Outcome drawn = here.call({"render", name, "-o", "picture.png"});
    EXPECT_EQ(drawn.status, 0) << drawn.err;
    EXPECT_TRUE(here.read("picture.png").starts_with("\x89PNG\r\n"));
    std::filesystem::remove(here.folder() / "picture.png");
  }
}

TEST(Pipeline, StandardInputAndOutputGiveTheSameBytes) {
  const Workplace here;
  here.simulate_tank();
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "tank.bt"}).status, 0);
  const Outcome mapped = here.call({"map", "-", "-o", "-"}, {.in = here.read("tank.csv")});
  EXPECT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_EQ(mapped.out, here.read("tank.bt"));
  const Outcome quiet = here.call({"map", "-", "-o", "-", "--quiet"}, {.in = here.read("tank.csv")});
  EXPECT_EQ(quiet.err, "");
  const Outcome chosen = here.call({"map", "tank.csv", "-o", "-", "--format", "ot", "--quiet"});
  EXPECT_TRUE(chosen.out.starts_with("# Octomap OcTree file")) << chosen.out.substr(0, 40);
  EXPECT_EQ(here.call({"info", "-", "--json"}, {.in = mapped.out}).out, here.call({"info", "tank.bt", "--json"}).out);
  EXPECT_EQ(here.call({"compare", "-", "tank.bt"}, {.in = mapped.out}).status, 0);
  EXPECT_EQ(here.call({"convert", "-", "-o", "-"}, {.in = here.read("tank.csv")}).out, here.read("tank.csv"));
}

TEST(Pipeline, TheSameCallGivesTheSameBytes) {
  const Workplace here;
  here.simulate_tank();
  const std::string log = here.read("tank.csv");
  here.simulate_tank();
  EXPECT_EQ(here.read("tank.csv"), log);
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "other.csv", "--turns", "2", "--seed", "2"}).status, 0);
  EXPECT_NE(here.read("other.csv"), log);
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "a.ot"}).status, 0);
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "b.ot", "--threads", "8"}).status, 0);
  EXPECT_EQ(here.read("a.ot"), here.read("b.ot"));
}

TEST(Pipeline, SeveralLogsBecomeOneMap) {
  const Workplace here;
  here.simulate_tank();
  here.write("scan.txt", "NODE 0 0 0 0 0 0\n1 0 0\n0 1 0\n0 0 30\n");
  FlatJson one = json_with(here.call({"map", "tank.csv", "-o", "a.ot", "--json"}), map_keys());
  FlatJson two = json_with(here.call({"map", "tank.csv", "tank.csv", "-o", "b.ot", "--json"}), map_keys());
  EXPECT_EQ(one["beams"], "400");
  EXPECT_EQ(two["beams"], "800");
  EXPECT_EQ(two["sweeps"], "4");
  FlatJson mixed = json_with(here.call({"map", "tank.csv", "scan.txt", "-o", "c.ot", "--json"}), map_keys());
  EXPECT_EQ(mixed["sweeps"], "3");
  EXPECT_THAT(mixed["map.bounds.max"], ::testing::HasSubstr(", 30.0"));
}

TEST(Compare, SaysWhatDiffers) {
  const Workplace here;
  here.write("a.txt", "NODE 0 0 0 0 0 0\n1 0 0\n");
  here.write("b.txt", "NODE 0 0 0 0 0 0\n1.1 0 0\n");
  ASSERT_EQ(here.call({"map", "a.txt", "-o", "a.ot", "--resolution", "0.1"}).status, 0);
  ASSERT_EQ(here.call({"map", "b.txt", "-o", "b.ot", "--resolution", "0.1"}).status, 0);
  const Outcome outcome = here.call({"compare", "a.ot", "b.ot", "--json"});
  EXPECT_EQ(outcome.status, 1);
  auto json = flat_json(outcome.out);
  ASSERT_TRUE(json) << outcome.out;
  EXPECT_EQ((*json)["cells"], "12");
  EXPECT_EQ((*json)["same"], "10");
  EXPECT_EQ((*json)["different"], "1");  // the end of the one is a miss of the other
  EXPECT_EQ((*json)["only_a"], "0");
  EXPECT_EQ((*json)["only_b"], "1");
  EXPECT_THAT(here.call({"compare", "a.ot", "b.ot"}).out, ::testing::HasSubstr("83.3333 % of the 12 cells"));
  EXPECT_EQ((*json)["classes.occupied_a"], "1");
  EXPECT_EQ((*json)["classes.occupied_b"], "1");
  EXPECT_EQ((*json)["classes.occupied_both"], "0");
  EXPECT_EQ((*json)["classes.free_a"], "10");
  EXPECT_EQ((*json)["classes.free_b"], "11");
  EXPECT_EQ((*json)["against_b.precision"], "1");  // one cell off is within one cell
  EXPECT_EQ((*json)["against_b.recall"], "1");
  EXPECT_EQ((*json)["against_b.free_true"], "1");

  ASSERT_EQ(here.call({"map", "b.txt", "-o", "fine.ot", "--resolution", "0.05"}).status, 0);
  expect_error(here.call({"compare", "a.ot", "fine.ot"}), 2, {"a.ot has cells of 0.1 m, fine.ot of 0.05 m"});
  ASSERT_EQ(here.call({"map", "b.txt", "-o", "deep.pvx", "--resolution", "0.1", "--depth", "20"}).status, 0);
  expect_error(here.call({"compare", "a.ot", "deep.pvx"}), 2, {"a.ot has 16 levels, deep.pvx has 20"});
}

TEST(Compare, LogOddsDecideUnlessAFileHoldsNone) {
  const Workplace here;
  here.write("a.txt", "NODE 0 0 0 0 0 0\n1 0 0\n");
  ASSERT_EQ(here.call({"map", "a.txt", "-o", "once.ot"}).status, 0);
  ASSERT_EQ(here.call({"map", "a.txt", "a.txt", "-o", "twice.ot"}).status, 0);
  ASSERT_EQ(here.call({"map", "a.txt", "a.txt", "-o", "twice.bt"}).status, 0);
  const Outcome with = here.call({"compare", "once.ot", "twice.ot"}),
                without = here.call({"compare", "once.ot", "twice.bt"});
  EXPECT_EQ(with.status, 1);
  EXPECT_EQ(without.status, 0);
  // How far they differ from what a .bt is read as is no difference of beliefs.
  EXPECT_THAT(with.out, ::testing::HasSubstr("differ by"));
  EXPECT_THAT(without.out, ::testing::Not(::testing::HasSubstr("differ by")));
  EXPECT_THAT(here.call({"compare", "once.ot", "twice.bt", "--json"}).out,
              ::testing::HasSubstr("max_log_odds_difference"));
}

TEST(Info, KnowsPointScansAndTrajectories) {
  const Workplace here;
  here.write("a.txt", "NODE 0 0 0 0 0 0\n1 0 0\n2 0 0\n");
  here.write("poses.txt", "0 0 0 0 0 0 0 1\n1 3 4 0 0 0 0 1\n");
  FlatJson scans = json_with(here.call({"info", "a.txt", "--json"}),
                             {"kind", "format", "scans", "points", "bounds.min", "bounds.max", "skipped"});
  EXPECT_EQ(scans["points"], "2");
  FlatJson poses =
      json_with(here.call({"info", "poses.txt", "--json"}),
                {"kind", "format", "poses", "duration_s", "length_m", "bounds.min", "bounds.max", "left_out"});
  EXPECT_EQ(poses["length_m"], "5");
}

TEST(Map, DeepMapsGoIntoPvxAndSayHowTheyWereMade) {
  const Workplace here;
  here.simulate_tank();
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "deep.pvx", "--depth", "40", "--hit-from", "fixed"}).status, 0);
  const Outcome info = here.call({"info", "deep.pvx"});
  EXPECT_THAT(info.out, ::testing::HasSubstr("40 levels"));
  EXPECT_THAT(info.out, ::testing::HasSubstr("map tank.csv -o deep.pvx --depth 40 --hit-from fixed"));
  for (const std::string name : {"deep.bt", "deep.ot"}) {
    expect_error(here.call({"convert", "deep.pvx", "-o", name}), 1, {name, "16", ".pvx"});
    EXPECT_FALSE(here.has(name));
  }
}

TEST(Map, ProgressGoesToStandardErrorOnlyWhenWanted) {
  const Workplace here;
  here.simulate_tank();
  EXPECT_EQ(here.call({"map", "tank.csv", "-o", "a.bt"}).err, "");
  EXPECT_EQ(here.call({"map", "tank.csv", "-o", "a.bt", "--progress", "never"}).err, "");
  const Outcome shown = here.call({"map", "tank.csv", "-o", "a.bt", "--progress", "always"});
  EXPECT_THAT(shown.err, ::testing::HasSubstr(" %  "));
  EXPECT_THAT(shown.err, ::testing::HasSubstr("beams"));
  EXPECT_TRUE(shown.err.ends_with("\r\x1b[K")) << "the line is left behind";
  EXPECT_EQ(here.call({"map", "tank.csv", "-o", "a.bt", "--quiet"}).out, "");
}

// Kills options that name a range or share and change nothing.
TEST(Map, RangeAndShareOfBeamsCount) {
  const Workplace here;
  here.simulate_tank();
  EXPECT_EQ(here.call({"map", "tank.csv", "-o", "a.bt", "--beam", "cone", "--quiet"}).status, 0);
  EXPECT_EQ(here.call({"map", "tank.csv", "-o", "b.bt", "--beam", "cone", "--free-share", "1", "--quiet"}).status, 0);
  EXPECT_GT(std::stol(json_with(here.call({"info", "b.bt", "--json"}), info_map_keys())["free_cells"]),
            std::stol(json_with(here.call({"info", "a.bt", "--json"}), info_map_keys())["free_cells"]));

  const Outcome cut = here.call({"map", "tank.csv", "-o", "c.bt", "--max-range", "1"});
  EXPECT_THAT(cut.out, ::testing::ContainsRegex(" 0 echoes, [0-9]+ beams without echo"));
  FlatJson map = json_with(here.call({"info", "c.bt", "--json"}), info_map_keys());
  EXPECT_EQ(map["occupied_cells"], "0");
  EXPECT_GT(std::stol(map["free_cells"]), 300);
  expect_error(here.call({"map", "tank.csv", "-o", "d.bt", "--max-range", "0.5"}), 2,
               {"--max-range: must be above --min-range (0.75 m by default), is 0.5 m"});
}

TEST(Map, TheRecordingOfTheTankHas28SweepsAnd4BeamsOver) {
  const std::string recording = PINGVOX_SHARED_DATA "/tank-static-mat/dataset_static.mat";
  if (!std::filesystem::exists(recording)) GTEST_SKIP() << recording << " is not there";
  const Workplace here;
  const std::string path = std::filesystem::canonical(recording);
  FlatJson made = json_with(here.call({"map", path, "-o", "tank.bt", "--resolution", "0.0125", "--json"}), map_keys());
  EXPECT_EQ(made["beams"], "5604");
  EXPECT_EQ(made["sweeps"], "28");
  EXPECT_EQ(made["skipped"], "0");
  FlatJson log = flat_json(here.call({"info", path, "--json"}).out).value_or(FlatJson{});
  EXPECT_EQ(log["bins.min"], "186");
  EXPECT_EQ(log["bins.max"], "399");
  EXPECT_EQ(log["sector_deg"], "360");
  FlatJson map = json_with(here.call({"info", "tank.bt", "--json"}), info_map_keys());
  EXPECT_EQ(map["free_cells"], made["map.free_cells"]);
  EXPECT_EQ(map["occupied_cells"], made["map.occupied_cells"]);
}

TEST(Json, EscapesWhatJsonDoesNotAllow) {
  JsonObject json;
  json.add("quote\"", "back\\slash\n\x01")
      .add("bad utf-8",
           "\xC3\x28\xFF"
           "a\xED\xA0\x80")
      .add("utf-8", "\xC3\xA4\xF0\x9F\x90\xA7");
  EXPECT_EQ(json.text(),
            "{\"quote\\\"\": \"back\\\\slash\\u000a\\u0001\", "
            "\"bad utf-8\": \"\xEF\xBF\xBD(\xEF\xBF\xBD"
            "a\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\", "
            "\"utf-8\": \"\xC3\xA4\xF0\x9F\x90\xA7\"}");
  EXPECT_TRUE(flat_json(json.text() + "\n"));
}

TEST(Json, NumbersThatAreNotFiniteAreNull) {
  JsonObject json;
  json.add("nan", std::numeric_limits<double>::quiet_NaN()).add("inf", -std::numeric_limits<double>::infinity());
  json.add("tenth", 0.1).add("most", std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(json.text(), R"({"nan": null, "inf": null, "tenth": 0.1, "most": 18446744073709551615})");
}

}  // namespace
}  // namespace pingvox::test
