// What a new user tries first, and what the program must say then.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

FlatJson json_of(const Outcome& outcome) {
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return flat_json(outcome.out).value_or(FlatJson{});
}

/// A log of full turns of 40 beams, a wall at bin 40.
std::string turns_csv(int beams, int first = 0, int bins = 100) {
  std::ostringstream csv;
  csv << "time_s,bearing_cw_deg,bin_length_m,intensities\n";
  for (int i = first; i < first + beams; ++i) {
    csv << i << "," << (i % 40) * 9 << ",0.1";
    for (int bin = 0; bin < bins; ++bin) csv << "," << (bin >= 40 && bin < 50 ? 200 : 5);
    csv << "\n";
  }
  return csv.str();
}

TEST(FirstUse, BeamsThatAreSkippedHaveAReason) {
  const Workplace here;
  here.write("a.csv", turns_csv(80) + "80,0,x\n");
  here.write("poses.txt", "0 0 0 0 0 0 0 1\n20 0 0 0 0 0 0 1\n");
  const Outcome outcome = here.call({"map", "a.csv", "-o", "a.bt", "--poses", "poses.txt"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("; 1 damaged record, the first: line 82: "));
  EXPECT_THAT(
      outcome.err,
      HasSubstr("a.csv: skipped 59 of 80 beams outside the time of the poses, 0.000 s to 20.000 s, the first at 21.000 "
                "s (--poses"));
  FlatJson json = json_of(here.call({"map", "a.csv", "-o", "a.bt", "--poses", "poses.txt", "--json"}));
  EXPECT_EQ(json["skipped_for.damage"], "1");
  EXPECT_EQ(json["skipped_for.no_pose"], "59");
  here.write("late.txt", "900 0 0 0 0 0 0 1\n901 0 0 0 0 0 0 1\n");
  expect_error(here.call({"map", "a.csv", "-o", "b.bt", "--poses", "late.txt"}), 1,
               {"a.csv: nothing could be mapped: 80 of 80 beams outside the time of the poses, 900.000 s",
                "; 1 damaged record"});
}

TEST(FirstUse, ATrajectoryBesideALogIsNamedWhenItIsNotUsed) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  here.write("a.tum", "0 0 0 0 0 0 0 1\n100 0 0 0 0 0 0 1\n");
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt"}).err, HasSubstr("as if the vehicle did not move"));
  EXPECT_EQ(here.call({"map", "a.csv", "-o", "a.bt", "--poses", "a.tum"}).err, "");
}

TEST(FirstUse, AnAssumedBeamIsReported) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt"}).out, HasSubstr("35 high, assumed (the log names no sonar"));
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt", "--device", "ping360"}).out, Not(HasSubstr("assumed")));
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt", "--beam-width", "2", "--beam-height", "25"}).out,
              Not(HasSubstr("assumed")));
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt", "--beam", "ray"}).out, Not(HasSubstr("assumed")));
}

TEST(FirstUse, ThresholdsOnAMapWithoutProbabilitiesAreRefused) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  ASSERT_EQ(here.call({"map", "a.csv", "-o", "a.bt"}).status, 0);
  const std::string why = "has no effect on a .bt";
  expect_error(here.call({"compare", "a.bt", "a.bt", "--occupied", "0.7"}), 2, {"a.bt: --occupied: " + why});
  expect_error(here.call({"convert", "a.bt", "-o", "a.ply", "--occupied", "0.7"}), 2, {"a.bt: --occupied: " + why});
  expect_error(here.call({"render", "a.bt", "-o", "a.png", "--free", "0.2"}), 2, {"a.bt: --free: " + why});
}

TEST(FirstUse, TheFirstDamagedRecordIsNamedByEachCommand) {
  const Workplace here;
  here.write("a.csv", turns_csv(40) + "40,0,0.1,5\n41,0,20000,1\n42,0,1,-\n");
  const std::string where = "damaged records, the first: line 43: a range of 20000 m is too long for a scanning sonar";
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt"}).err, HasSubstr(where + " (--strict stops there)"));
  EXPECT_THAT(here.call({"info", "a.csv"}).out, HasSubstr("2 " + where));
  EXPECT_THAT(here.call({"convert", "a.csv", "-o", "b.csv"}).out, HasSubstr("skipped 2 " + where));
}

// Kills a map of positions alone, as of fixes without attitude.
TEST(FirstUse, PosesThatNeverTurnAreQuestioned) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  const auto errors_of = [&](const char* last_turn) {
    std::string poses;
    for (int i = 0; i < 20; ++i) {
      poses +=
          std::to_string(2 * i) + " " + std::to_string(0.1 * i) + " 0 0 0 0 " + (i < 19 ? "0 1" : last_turn) + "\n";
    }
    here.write("fixes.tum", poses);
    return here.call({"map", "a.csv", "-o", "a.bt", "--poses", "fixes.tum"}).err;
  };
  EXPECT_THAT(errors_of("0 1"), HasSubstr("fixes.tum: its poses move but never turn: is the attitude known?"));
  EXPECT_THAT(errors_of("0.1 0.995"), Not(HasSubstr("never turn")));
}

// Kills echoes in a corner of a picture of 60 m, for the sake of one far away.
TEST(FirstUse, PicturesOfLongRangesEndBehindTheEchoes) {
  const Workplace here;
  std::string csv = "time_s,bearing_cw_deg,bin_length_m,intensities\n";
  for (int beam = 0; beam < 200; ++beam) {
    csv += std::to_string(beam) + "," + std::to_string(1.8 * beam) + ",0.1";
    const int wall = beam == 100 ? 400 : 50;
    for (int bin = 0; bin < 600; ++bin) csv += (bin / 6 == wall / 6) ? ",200" : ",10";
    csv += "\n";
  }
  here.write("a.csv", csv);
  for (const char* view : {"polar", "cartesian"}) {
    EXPECT_THAT(here.call({"render", "a.csv", "-o", "a.png", "--view", view}).out,
                HasSubstr("drawn to 6 m of 60 m, where nearly all echoes are (--max-range 60 draws all)"));
    EXPECT_THAT(here.call({"render", "a.csv", "-o", "all.png", "--view", view, "--max-range", "60"}).out,
                Not(HasSubstr("drawn to")));
    EXPECT_NE(here.read("a.png"), here.read("all.png"));
  }
}

TEST(FirstUse, PosesInMillisecondsAreQuestioned) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  here.write("ms.txt", "0 0 0 0 0 0 0 1\n39000 1 0 0 0 0 0 1\n");
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt", "--poses", "ms.txt"}).err,
              HasSubstr("ms.txt: its poses last 39000 s, the log 39 s: are their times in seconds?"));
  here.write("s.txt", "0 0 0 0 0 0 0 1\n39 1 0 0 0 0 0 1\n");
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt", "--poses", "s.txt"}).err, Not(HasSubstr("are their times in")));
}

TEST(FirstUse, ALongLogWithNearEchoesSaysHowToDrawAll) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  EXPECT_THAT(here.call({"render", "a.csv", "-o", "a.png", "--view", "cartesian"}).out, Not(HasSubstr("--max-range")));
  here.write("far.csv", turns_csv(40, 0, 500));
  EXPECT_THAT(here.call({"render", "far.csv", "-o", "a.png", "--view", "cartesian"}).out, HasSubstr("--max-range 50"));
}

/// A wall at 4 m, and the vehicle's own frame at 1 m ahead of the head.
std::string framed_csv(int turns = 6) {
  std::ostringstream csv;
  csv << "time_s,bearing_cw_deg,bin_length_m,intensities\n";
  for (int i = 0; i < 40 * turns; ++i) {
    csv << i << "," << (i % 40) * 9 << ",0.1";
    for (int bin = 0; bin < 100; ++bin) {
      const bool is_frame = i % 40 < 3 && bin >= 10 && bin < 12, is_wall = bin >= 40 && bin < 50;
      csv << "," << (is_frame || is_wall ? 200 : 5);
    }
    csv << "\n";
  }
  return csv.str();
}

TEST(FirstUse, TheVehicleIsTakenOutOfItsOwnPicture) {
  const Workplace here;
  here.write("a.csv", framed_csv());
  const auto nearest_m = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"convert", "a.csv", "--echoes", "-o", "echoes.csv"});
    EXPECT_EQ(here.call(words).status, 0);
    std::istringstream echoes(here.read("echoes.csv"));
    std::string line;
    std::getline(echoes, line);
    double nearest = 100.0;
    for (std::string word; std::getline(echoes, line);) {
      std::istringstream words_of(line);
      for (int column = 0; column < 3; ++column) std::getline(words_of, word, ',');
      nearest = std::min(nearest, std::stod(word));
    }
    return nearest;
  };
  EXPECT_LT(nearest_m({}), 2.0);
  EXPECT_GT(nearest_m({"--background", "2"}), 3.5);
  EXPECT_EQ(here.call({"map", "a.csv", "-o", "a.bt", "--beam", "ray", "--background", "2"}).status, 0);
  EXPECT_EQ(here.call({"map", "a.csv", "-o", "b.bt", "--beam", "ray"}).status, 0);
  EXPECT_NE(here.read("a.bt").substr(here.read("a.bt").find("data")),
            here.read("b.bt").substr(here.read("b.bt").find("data")));
  EXPECT_EQ(here.call({"render", "a.csv", "-o", "a.png", "--background", "2", "--show", "background"}).status, 0);
  expect_error(here.call({"render", "a.csv", "-o", "a.png", "--show", "background"}), 2, {"--background M"});
  expect_error(here.call({"map", "-", "-o", "c.bt", "--background", "2"}, {.in = framed_csv()}), 2, {"read only once"});
}

// Kills a background that has no effect on short logs, and does not say so.
TEST(FirstUse, TheVehicleIsLearnedFromAllLogs) {
  const Workplace here;
  here.write("a.csv", framed_csv(3));
  here.write("b.csv", framed_csv(3));
  const std::vector<std::string> options = {"-o", "a.bt", "--beam", "ray", "--background", "2"};
  const auto mapped = [&](std::vector<std::string> words) {
    words.insert(words.end(), options.begin(), options.end());
    return here.call(words);
  };
  expect_error(mapped({"map", "a.csv"}), 1, {"a.csv: --background: needs 5 beams of one direction"});
  expect_error(here.call({"render", "a.csv", "-o", "a.png", "--background", "2"}), 1, {"needs 5 beams"});
  expect_error(here.call({"convert", "a.csv", "-o", "b.csv", "--background", "2", "--echoes"}), 1, {"needs 5 beams"});
  EXPECT_EQ(mapped({"map", "a.csv", "b.csv"}).status, 0);
  EXPECT_EQ(here.call({"map", "a.csv", "b.csv", "-o", "with.bt", "--beam", "ray"}).status, 0);
  EXPECT_NE(here.read("a.bt").substr(here.read("a.bt").find("data")),
            here.read("with.bt").substr(here.read("with.bt").find("data")));
}

// Kills a salinity that is taken for a temperature, and a speed that goes the wrong way.
TEST(FirstUse, TheSpeedOfSoundComesFromTheWater) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  const auto echoes = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"convert", "a.csv", "--echoes", "-o", "echoes.csv"});
    EXPECT_EQ(here.call(words).status, 0);
    return here.read("echoes.csv");
  };
  // Coppens 1981: 1482.355 m/s at 20 degrees in fresh water, 1521.45 in the ocean.
  EXPECT_EQ(echoes({"--water", "20,0"}).substr(0, 120), echoes({"--sound-speed", "1482.355"}).substr(0, 120));
  EXPECT_NE(echoes({"--water", "20,35"}), echoes({"--water", "20,0"}));
  expect_error(here.call({"map", "a.csv", "-o", "a.bt", "--water", "20,35", "--sound-speed", "1480"}), 2,
               {"--sound-speed and --water: exclude each other"});
  expect_error(here.call({"map", "a.csv", "-o", "a.bt", "--water", "20"}), 2, {"T,S or T,S,D"});
  expect_error(here.call({"map", "a.csv", "-o", "a.bt", "--water", "60,0"}), 2, {"--water", "0..35"});
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt", "--water", "20,0"}).out, HasSubstr("sound       1482.4 m/s\n"));
  EXPECT_THAT(here.call({"map", "a.csv", "-o", "a.bt"}).out, Not(HasSubstr("m/s")));
}

// Kills help that offers the water of a navigation log to commands that have none.
TEST(FirstUse, TheWaterOfNavigationIsOfferedWhereThereIsNavigation) {
  const Workplace here;
  for (const char* command : {"map", "render", "slam", "locate"}) {
    EXPECT_THAT(here.call({command, "--help"}).out, HasSubstr("--water T,S[,D]|nav,S")) << command;
  }
  for (const char* command : {"live", "convert"}) {
    const Outcome help = here.call({command, "--help"});
    EXPECT_THAT(help.out, HasSubstr("--water T,S[,D] ")) << command;
    EXPECT_THAT(help.out, Not(HasSubstr("nav,S"))) << command;
  }
}

TEST(FirstUse, AMapIsMadeOfConesAndSaysSo) {
  const Workplace here;
  here.simulate_tank();
  FlatJson json = json_of(here.call({"map", "tank.csv", "-o", "a.ot", "--json"}));
  EXPECT_EQ(json["beam.shape"], "\"cone\"");
  EXPECT_EQ(json["beam.width_deg"], "3");
  EXPECT_EQ(json["beam.height_deg"], "35");
  EXPECT_EQ(here.call({"map", "tank.csv", "-o", "b.ot", "--beam", "cone", "--quiet"}).status, 0);
  EXPECT_EQ(here.read("a.ot"), here.read("b.ot"));
}

TEST(FirstUse, TheBeamsOfAllHeadsAreNamed) {
  const Workplace here;
  here.simulate_tank();
  const std::string other = PINGVOX_SOURCE_DIR "/fuzz/corpus/pingviewer/utf8.bin";
  const Outcome text = here.call({"map", "tank.csv", other, "tank.csv", "-o", "a.bt"});
  EXPECT_THAT(text.out, HasSubstr("tank.csv: cone, 3 degrees wide, 35 high, assumed"));
  EXPECT_THAT(text.out, HasSubstr(other + ": cone, 2 degrees wide, 25 high\n"));
  const Outcome json = here.call({"map", "tank.csv", other, "-o", "a.bt", "--json"});
  EXPECT_THAT(json.out, HasSubstr(R"("beam": {"shape": "cone", "width_deg": 3, "height_deg": 35})"));
  EXPECT_THAT(json.out, HasSubstr(R"({"shape": "cone", "width_deg": 2, "height_deg": 25, "log": )"));
}

TEST(FirstUse, TheThresholdThatWasUsedIsShown) {
  const Workplace here;
  here.simulate_tank();
  FlatJson automatic = json_of(here.call({"map", "tank.csv", "-o", "a.bt", "--threshold", "auto", "--json"}));
  EXPECT_NE(automatic["threshold.min"], "null");
  FlatJson log = json_of(here.call({"info", "tank.csv", "--json"}));
  EXPECT_EQ(log["threshold.min"], automatic["threshold.min"]);
  EXPECT_EQ(log["threshold.max"], automatic["threshold.max"]);
  FlatJson given = json_of(here.call({"map", "tank.csv", "-o", "a.bt", "--threshold", "40", "--json"}));
  EXPECT_EQ(given["threshold.min"], "40");
  EXPECT_EQ(given["threshold.max"], "40");
  EXPECT_THAT(here.call({"render", "tank.csv", "-o", "a.png"}).out, HasSubstr("(automatic)"));
}

TEST(FirstUse, EchoesAreATable) {
  const Workplace here;
  here.write("a.csv", turns_csv(80));
  ASSERT_EQ(here.call({"convert", "a.csv", "--echoes", "-o", "e.csv"}).status, 0);
  std::istringstream table(here.read("e.csv"));
  std::string header, line;
  std::getline(table, header);
  EXPECT_EQ(header, "time_s,bearing_rad,range_m,intensity,first_bin,peak_bin,last_bin,threshold");
  int lines = 0;
  for (; std::getline(table, line); ++lines) {
    double time = 0.0, bearing = 0.0, range = 0.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &time, &bearing, &range), 3) << line;
    EXPECT_EQ(time, lines);
    EXPECT_NEAR(range, 4.5, 0.5);
  }
  EXPECT_EQ(lines, 80);
}

// Kills a value that is taken for the file, and a file that is taken for the value.
TEST(FirstUse, AllEchoesOfABeamCanBeHad) {
  const Workplace here;
  // An echo at 2 m and a wall behind it at 4.5 m.
  std::string csv = "time_s,bearing_cw_deg,bin_length_m,intensities\n";
  for (int beam = 0; beam < 40; ++beam) {
    csv += std::to_string(beam) + "," + std::to_string(9 * beam) + ",0.1";
    for (int bin = 0; bin < 60; ++bin) csv += (bin / 3 == 6 || bin / 3 == 15) ? ",200" : ",10";
    csv += "\n";
  }
  here.write("a.csv", csv);
  const auto lines_of = [&](const std::vector<std::string>& words) {
    EXPECT_EQ(here.call(words).status, 0);
    const std::string table = here.read("e.csv");
    return std::count(table.begin(), table.end(), '\n') - 1;
  };
  EXPECT_EQ(lines_of({"convert", "--echoes", "a.csv", "-o", "e.csv"}), 40);
  EXPECT_EQ(lines_of({"convert", "a.csv", "--echoes", "first", "-o", "e.csv"}), 40);
  EXPECT_EQ(lines_of({"convert", "--echoes", "all", "a.csv", "-o", "e.csv"}), 80);
  EXPECT_EQ(lines_of({"convert", "--echoes=all", "a.csv", "-o", "e.csv"}), 80);
}

// Both counted sweeps, one without those that are not complete.
TEST(FirstUse, InfoAndRenderNumberSweepsAlike) {
  const Workplace here;
  here.write("a.csv", turns_csv(90));
  EXPECT_THAT(here.call({"info", "a.csv"}).out, HasSubstr("3, complete: 1-2\n"));
  EXPECT_THAT(here.call({"render", "a.csv", "-o", "a.png", "--sweep", "3"}).out, HasSubstr("10 beams"));
  EXPECT_THAT(here.call({"render", "a.csv", "-o", "a.png", "--view", "cartesian"}).out, HasSubstr("sweep 1, 40 beams"));
  expect_error(here.call({"render", "a.csv", "-o", "b.png", "--sweep", "4"}), 2, {"no sweep 4", "3"});
}

TEST(FirstUse, BinLengthsAreListedWithTheirBeams) {
  const Workplace here;
  std::string csv = turns_csv(3);
  csv += "3,27,0.2,1,2,3\n";
  here.write("a.csv", csv);
  EXPECT_THAT(here.call({"info", "a.csv"}).out, HasSubstr("0.1 m (3 beams), 0.2 m (1 beam)"));
}

TEST(FirstUse, APictureEndsAtTheMaximumRange) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  ASSERT_EQ(here.call({"render", "a.csv", "-o", "all.png"}).status, 0);
  ASSERT_EQ(here.call({"render", "a.csv", "-o", "near.png", "--max-range", "6"}).status, 0);
  EXPECT_NE(here.read("all.png"), here.read("near.png"));
}

TEST(FirstUse, ASliceInWhichNothingIsKnownIsAnError) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  ASSERT_EQ(here.call({"map", "a.csv", "-o", "a.bt", "--quiet"}).status, 0);
  expect_error(here.call({"render", "a.bt", "-o", "a.png", "--view", "slice", "--z", "50"}), 1,
               {"a.bt", "nothing is known"});
  expect_error(here.call({"convert", "a.bt", "-o", "a.ply", "--z", "50"}), 1, {"a.bt", "nothing is known"});
}

TEST(FirstUse, ALayerOfAMapIsWrittenAsPointsAndAsAMap) {
  const Workplace here;
  here.write("a.csv", turns_csv(40));
  ASSERT_EQ(here.call({"map", "a.csv", "-o", "a.ot", "--quiet"}).status, 0);
  ASSERT_EQ(here.call({"convert", "a.ot", "-o", "layer.xyz", "--z", "0.01"}).status, 0);
  std::istringstream points(here.read("layer.xyz"));
  double x = 0.0, y = 0.0, z = 0.0, log_odds = 0.0, size = 0.0;
  int count = 0;
  while (points >> x >> y >> z >> log_odds >> size) {
    EXPECT_NEAR(z, 0.025, 1e-6);
    ++count;
  }
  EXPECT_GT(count, 10);
  ASSERT_EQ(here.call({"convert", "a.ot", "-o", "layer.ot", "--z", "0.01"}).status, 0);
  FlatJson layer = json_of(here.call({"info", "layer.ot", "--json"}));
  EXPECT_EQ(layer["occupied_cells"], std::to_string(count));
  FlatJson same =
      flat_json(here.call({"compare", "a.ot", "layer.ot", "--layer", "0.01", "--json"}).out).value_or(FlatJson{});
  EXPECT_EQ(same["different"], "0");
  EXPECT_EQ(same["only_a"], "0");
}

TEST(FirstUse, CompareCountsCellsAboveAProbability) {
  const Workplace here;
  here.write("a.csv", turns_csv(80));
  ASSERT_EQ(here.call({"map", "a.csv", "-o", "a.ot", "--quiet"}).status, 0);
  const auto occupied = [&](const char* p) {
    FlatJson json =
        flat_json(here.call({"compare", "a.ot", "a.ot", "--occupied", p, "--json"}).out).value_or(FlatJson{});
    return std::stol(json["classes.occupied_a"]);
  };
  EXPECT_GT(occupied("0.5"), occupied("0.6"));
}

TEST(FirstUse, ASpreadsheetsSemicolonsAreRead) {
  const Workplace here;
  std::string csv = turns_csv(40);
  here.write("comma.csv", csv);
  std::ranges::replace(csv, ',', ';');
  here.write("semicolon.csv", csv);
  ASSERT_EQ(here.call({"convert", "comma.csv", "-o", "a.csv"}).status, 0);
  ASSERT_EQ(here.call({"convert", "semicolon.csv", "-o", "b.csv"}).status, 0);
  EXPECT_EQ(here.read("a.csv"), here.read("b.csv"));
}

// A head that looks down from half a metre ahead hears other walls; a map with the same mount is where the walls are.
TEST(FirstUse, ASimulatedHeadIsMountedAsAsked) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "a.csv", "--turns", "1", "--mount", "0.5,0,0,0,0,90"}).status, 0);
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "b.csv", "--turns", "1"}).status, 0);
  EXPECT_NE(here.read("a.csv"), here.read("b.csv"));
  const auto bounds = [&](const std::string& log, const std::string& mount) {
    FlatJson json = json_of(here.call({"map", log, "-o", "m.bt", "--mount", mount, "--beam", "ray", "--json"}));
    return json["map.bounds.min"];
  };
  EXPECT_NE(bounds("a.csv", "0.5,0,0,0,0,90"), bounds("a.csv", "0,0,0,0,0,0"));
}

}  // namespace
}  // namespace pingvox::test
