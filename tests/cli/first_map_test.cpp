// What somebody meets on the way to a first map.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "call.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Beams in bins of 0.1 m with one echo at 2 m.
std::string beams_of_range(int range_m, int beams = 40) {
  std::string text = "time_s,bearing_cw_deg,bin_length_m,intensities\n";
  for (int n = 0; n < beams; ++n) {
    text += fmt::format("{},{},0.1", 0.1 * n, 9 * n % 360);
    for (int bin = 0; bin < 10 * range_m; ++bin) text += bin == 20 ? ",200" : ",0";
    text += '\n';
  }
  return text;
}

TEST(FirstMap, OfAFolderIsThatOfItsLogs) {
  const Workplace here;
  std::filesystem::create_directory(here.folder() / "dive");
  here.write("dive/b.csv", beams_of_range(5));
  here.write("dive/a.csv", beams_of_range(5, 20));
  here.write("dive/notes.txt", "a good dive\n");
  here.write("dive/nav.csv", "time_s,source,quantity,x,y,z\n0,compass,heading,1,,\n");
  const Outcome mapped = here.call({"map", "dive", "-o", "folder.ot"});
  ASSERT_EQ(mapped.status, 0) << mapped.err;
  EXPECT_THAT(mapped.err, HasSubstr("dive: takes 2 logs in it; navigation (--nav): dive/nav.csv; skipped: notes.txt"));
  ASSERT_EQ(here.call({"map", "dive/a.csv", "dive/b.csv", "-o", "files.ot"}).status, 0);
  EXPECT_EQ(here.read("folder.ot"), here.read("files.ot"));

  std::filesystem::create_directory(here.folder() / "empty");
  here.write("empty/notes.txt", "nothing here\n");
  expect_error(here.call({"map", "empty", "-o", "m.bt"}), 1, {"empty"});
}

// Kills logs of several dives that become one map and nothing says so, and a dive in parts that is called several.
TEST(FirstMap, OfStillLogsOfSeveralDatesSaysSo) {
  const Workplace here;
  here.simulate_tank();
  const std::string log = here.read("tank.csv");
  for (const char* name : {"20210611-215610861.csv", "20210611-221030000.csv", "20210829-000220346.csv"}) {
    here.write(name, log);
  }
  const auto said = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "map");
    words.insert(words.end(), {"-o", "tank.bt"});
    return here.call(words).err;
  };
  EXPECT_THAT(said({"20210829-000220346.csv", "20210611-215610861.csv", "tank.csv"}),
              HasSubstr("the logs are of several dates, 2021-06-11 to 2021-08-29, and are mapped as if"));
  EXPECT_THAT(said({"20210611-215610861.csv", "20210611-221030000.csv"}), Not(HasSubstr("several dates")));
  here.write("dive.tum", "0 0 0 0 0 0 0 1\n1000 0 0 0 0 0 0 1\n");
  EXPECT_THAT(said({"20210829-000220346.csv", "20210611-215610861.csv", "--poses", "dive.tum"}),
              Not(HasSubstr("several dates")));
}

TEST(FirstMap, SaysWhyItsCellsAreAsLargeAsTheyAre) {
  const Workplace here;
  here.write("near.csv", beams_of_range(5));
  here.write("far.csv", beams_of_range(50));
  EXPECT_THAT(here.call({"map", "near.csv", "-o", "m.bt"}).out,
              HasSubstr("cells       0.05 m, by a range of 5 m and a beam 3 degrees wide, 16 levels\n"));
  EXPECT_THAT(here.call({"map", "far.csv", "-o", "m.bt"}).out, HasSubstr("cells       0.25 m, by a range of 50 m"));
  EXPECT_THAT(here.call({"map", "-", "-o", "m.bt"}, {.in = here.read("far.csv")}).out, HasSubstr("cells       0.25 m"));
  const Outcome json = here.call({"map", "far.csv", "-o", "m.bt", "--json"});
  EXPECT_THAT(json.out, HasSubstr(R"("resolution": 0.25)"));
  EXPECT_THAT(json.out, HasSubstr(R"("resolution_from": {"range_m": 50, "beam_width_deg": 3})"));
  const Outcome asked = here.call({"map", "far.csv", "-o", "m.bt", "--resolution", "0.5", "--json"});
  EXPECT_THAT(asked.out, HasSubstr(R"("resolution": 0.5)"));
  EXPECT_THAT(asked.out, HasSubstr(R"("resolution_from": {"range_m": null, "beam_width_deg": null})"));
  EXPECT_THAT(here.call({"live", "replay:far.csv@max", "-o", "live.bt"}).out, HasSubstr("cells       0.25 m"));
}

TEST(FirstMap, SaysBeforehandWhatMayTakeLong) {
  const Workplace here;
  here.write("far.csv", beams_of_range(100, 400));
  const Outcome fine = here.call({"map", "far.csv", "-o", "m.bt", "--resolution", "0.05"});
  ASSERT_EQ(fine.status, 0) << fine.err;
  EXPECT_THAT(fine.err, HasSubstr("400 beams of 100 m in cells of 0.05 m may take up to "));
  EXPECT_THAT(fine.err, HasSubstr("(--resolution 0.1)"));
  EXPECT_EQ(here.call({"map", "far.csv", "-o", "m.bt", "--resolution", "0.05", "--quiet"}).err, "");
  EXPECT_THAT(here.call({"map", "far.csv", "-o", "m.bt"}).err, Not(HasSubstr("may take")));
}

TEST(FirstMap, HelpBeginsWithWhatMostNeed) {
  const Workplace here;
  const std::string help = here.call({"map", "--help"}).out;
  const std::size_t most = help.find("Most used:"), output = help.find("\nOutput:");
  ASSERT_LT(most, output);
  ASSERT_NE(output, std::string::npos);
  const std::string first = help.substr(most, output - most);
  const std::string others = help.substr(output, help.find("\nExamples:") - output);
  for (const char* option : {"--output", "--nav FILE", "--mount", "--resolution", "--max-range", "--beam "}) {
    EXPECT_THAT(first, HasSubstr(option));
    EXPECT_THAT(others, Not(HasSubstr(std::string("\n      ") + option))) << "is there once";
  }
  EXPECT_THAT(help, HasSubstr("  LOG... "));
  EXPECT_THAT(first, HasSubstr("repeatable"));
}

/// A drive in a simulated harbour, as dive.csv and nav.csv.
void simulate_harbour(const Workplace& here) {
  ASSERT_EQ(here.call({"simulate", "harbour", "-o", "dive.csv", "--trajectory", "loop", "--turns", "6", "--nav",
                       "nav.csv", "--seed", "2", "--quiet"})
                .status,
            0);
}

TEST(FirstMap, AlongSlamTakesTheOptionsOfMap) {
  const Workplace here;
  simulate_harbour(here);
  const std::vector<std::string> how = {"--resolution", "0.2", "--beam", "ray", "--hit", "0.8", "--depth", "18"};
  std::vector<std::string> slam = {"slam",    "dive.csv",   "--nav", "nav.csv", "-o",
                                   "out.tum", "--matching", "none",  "--map",   "slam.pvx"};
  std::vector<std::string> map = {"map", "dive.csv", "--poses", "out.tum", "-o", "map.pvx"};
  slam.insert(slam.end(), how.begin(), how.end());
  map.insert(map.end(), how.begin(), how.end());
  const Outcome made = here.call(slam);
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("without --mount the head is assumed at the origin"));
  EXPECT_THAT(made.out, HasSubstr("cells       0.2 m\n"));
  ASSERT_EQ(here.call(map).status, 0);
  const Outcome same = here.call({"compare", "slam.pvx", "map.pvx"});
  EXPECT_EQ(same.status, 0) << same.out;
  for (const char* option : {"--beam-width", "--free-share"}) {
    expect_error(here.call({"slam", "dive.csv", "--nav", "nav.csv", "-o", "out.tum", option, "0.5"}), 2,
                 {std::string(option) + ": has no effect without --map"});
  }
  expect_error(here.call({"slam", "dive.csv", "--nav", "nav.csv", "-o", "out.tum", "--beam", "ray"}), 2, {"--beam"});
  expect_error(here.call({"slam", "dive.csv", "--nav", "nav.csv", "-o", "out.tum", "--map", "a.bt", "--depth", "18"}),
               2, {"a.bt", ".pvx"});
}

// Kills maps of one dive that do not lie on each other, and a north that is forgotten on the way to the picture.
TEST(FirstMap, OfNavigationLiesOnThatOfSlamWithTheNorthUp) {
  const Workplace here;
  simulate_harbour(here);
  ASSERT_EQ(here.call({"map", "dive.csv", "--nav", "nav.csv", "-o", "nav.bt", "--resolution", "0.2"}).status, 0);
  ASSERT_EQ(here.call({"slam", "dive.csv", "--nav", "nav.csv", "-o", "out.tum", "--matching", "none", "--map",
                       "slam.bt", "--resolution", "0.2"})
                .status,
            0);
  for (const char* map : {"nav.bt", "slam.bt"}) EXPECT_THAT(here.read(map), HasSubstr("\n# x east, y north\n")) << map;
  const Outcome compared = here.call({"compare", "nav.bt", "slam.bt", "--json"});
  const std::size_t at = compared.out.find("\"precision\": ");
  ASSERT_NE(at, std::string::npos) << compared.out;
  EXPECT_GT(std::stod(compared.out.substr(at + 13)), 0.9) << compared.out;
  // The north goes on through other formats.
  for (const char* file : {"north.pvx", "north.ot"}) {
    ASSERT_EQ(here.call({"convert", "nav.bt", "-o", file}).status, 0);
    EXPECT_THAT(here.read(file), HasSubstr("x east, y north"));
  }
  ASSERT_EQ(here.call({"convert", "north.pvx", "-o", "again.bt"}).status, 0);
  EXPECT_EQ(here.read("again.bt"), here.read("nav.bt"));
  const auto picture = [&](const std::string& map, const std::vector<std::string>& how) {
    std::vector<std::string> words = {"render", map, "-o", "p.png", "--quiet"};
    words.insert(words.end(), how.begin(), how.end());
    const Outcome drawn = here.call(words);
    EXPECT_EQ(drawn.status, 0) << drawn.err;
    return here.read("p.png");
  };
  EXPECT_EQ(picture("nav.bt", {}), picture("nav.bt", {"--up", "north"}));
  EXPECT_NE(picture("nav.bt", {}), picture("nav.bt", {"--up", "ahead"}));
  EXPECT_NE(picture("nav.bt", {"--path", "out.tum"}), picture("nav.bt", {}));
}

}  // namespace
}  // namespace pingvox::test
