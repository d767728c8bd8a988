// Valid and invalid command lines.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "call.hpp"

namespace pingvox::test {
namespace {

using ::testing::HasSubstr;
using Args = std::vector<std::string>;

TEST(Usage, InvalidArgumentsAreRefusedWithTheNearestValidOneBeforeAnyWork) {
  struct Case {
    Args words;
    Args texts;
  };
  const std::vector<Case> cases = {
      {{}, {"a command is missing", "--help"}},
      {{"mpa"}, {"unknown command 'mpa'", "did you mean 'map'?"}},
      {{"cnvert", "a"}, {"did you mean 'convert'?"}},
      {{"xyzzy"}, {"unknown command 'xyzzy'", "--help"}},
      {{"map", "a.csv", "-o", "a.bt", "-r", "1"}, {"unknown option '-r' (see 'pingvox map --help')"}},
      {{"--versoin"}, {"unknown option", "did you mean '--version'?"}},
      {{"map"}, {"map: LOG is missing"}},
      {{"map", "log.csv"}, {"map: -o FILE is missing"}},
      {{"slam", "log.csv"}, {"slam: -o FILE is missing"}},
      {{"locate", "log.csv", "--map", "m.bt"}, {"locate: -o FILE is missing"}},
      {{"map", "log.csv", "-o", "m.bt", "--resolutoin", "0.1"}, {"'--resolutoin'", "did you mean '--resolution'?"}},
      {{"map", "log.csv", "-o", "m.bt", "--resolutoin=0.1"}, {"'--resolutoin'", "did you mean '--resolution'?"}},
      {{"map", "log.csv", "-o", "m.bt", "--res", "0.1"}, {"'--res'", "did you mean '--resolution'?"}},
      {{"map", "log.csv", "-o", "m.bt", "--resolution"}, {"--resolution", "needs a value"}},
      {{"map", "log.csv", "-o", "m.bt", "--resolution", "abc"}, {"--resolution", "'abc' is not a number of metres"}},
      {{"map", "log.csv", "-o", "m.bt", "--resolution", "0,1"}, {"--resolution", "'0,1' is not a number"}},
      {{"map", "log.csv", "-o", "m.bt", "--resolution", "-1"}, {"resolution", "-1"}},
      {{"map", "log.csv", "-o", "m.bt", "--resolution", "nan"}, {"resolution", "nan"}},
      {{"map", "log.csv", "-o", "m.bt", "--depth", "0"}, {"depth"}},
      {{"map", "log.csv", "-o", "m.bt", "--depth", "1e1"}, {"--depth", "'1e1' is not a whole number"}},
      {{"map", "log.csv", "-o", "m.bt", "--depth", "99999999999"}, {"--depth", "out of range"}},
      {{"map", "log.csv", "-o", "m.bt", "--depth", "17"}, {"m.bt", "16 levels", ".pvx"}},
      {{"map", "log.csv", "-o", "m.bt", "--beam", "cnoe"}, {"ray or fan or cone", "did you mean 'cone'?"}},
      {{"map", "log.csv", "-o", "m.bt", "--vote", "sweeps"}, {"did you mean 'sweep'?"}},
      {{"map", "log.csv", "-o", "m.bt", "--filter", "meadian"}, {"--filter", "did you mean 'median'?"}},
      {{"map", "log.csv", "-o", "m.bt", "--detect", "cany"}, {"--detect", "did you mean 'canny'?"}},
      {{"map", "log.csv", "-o", "m.bt", "--hit", "0"}, {"--hit", "probability"}},
      {{"map", "log.csv", "-o", "m.bt", "--hit", "0.3"}, {"hit"}},
      {{"map", "log.csv", "-o", "m.bt", "--miss", "0.9"}, {"miss"}},
      {{"map", "log.csv", "-o", "m.bt", "--clamp", "0.9,0.1"}, {"--clamp"}},
      {{"map", "log.csv", "-o", "m.bt", "--clamp", "0.1"}, {"--clamp", "2 numbers"}},
      {{"map", "log.csv", "-o", "m.bt", "--mount", "1,2,3"}, {"--mount", "6 numbers"}},
      {{"map", "log.csv", "-o", "m.bt", "--mount", "1,2,3,4,5,inf"}, {"--mount", "finite"}},
      {{"map", "log.csv", "-o", "m.bt", "--sound-speed", "0"}, {"--sound-speed"}},
      {{"map", "log.csv", "-o", "m.bt", "--threads", "0"}, {"--threads"}},
      {{"map", "log.csv", "-o", "m.bt", "--kernel", "4"}, {"--kernel: must be odd, is 4"}},
      {{"map", "log.csv", "-o", "m.bt", "--threshold", "0"}, {"threshold"}},
      {{"map", "log.csv", "-o", "m.bt", "--threshold", "300"}, {"threshold", "1..255"}},
      {{"map", "log.csv", "-o", "m.bt", "--detect", "canny", "--threshold", "3000"}, {"threshold", "1..2040"}},
      {{"map", "log.csv", "-o", "m.bt", "--cfar", "xo"}, {"--cfar", "ca or so or go or os"}},
      {{"map", "log.csv", "-o", "m.bt", "--free-share", "1.5"},
       {"--free-share: must be above 0 and at most 1, is 1.5"}},
      {{"map", "log.csv", "-o", "m.bt", "--hit", "0.3"}, {"--hit: must be above 0.5 and below 1, is 0.3"}},
      {{"map", "log.csv", "-o", "m.bt", "--min-range", "outo"}, {"--min-range"}},
      {{"map", "log.csv", "-o", "m.bt", "--min-bin", "-1"}, {"--min-bin"}},
      {{"map", "log.csv", "-o", "m.bt", "--memory-limit", "2X"}, {"--memory-limit", "512M"}},
      {{"map", "log.csv", "-o", "m.bt", "--memory-limit", "99999999999G"}, {"--memory-limit", "out of range"}},
      {{"map", "log.csv", "-o", "m.bt", "--json=maybe"}, {"--json"}},
      {{"map", "log.csv", "-o", "m.btt"}, {"m.btt", ".bt", "did you mean '.bt'?"}},
      {{"map", "log.csv", "-o", "m.png"}, {"m.png", ".pvx"}},
      {{"map", "log.csv", "-o", "m"}, {"m: its suffix"}},
      {{"map", "log.csv", "-o", "-", "--json"}, {"standard output"}},
      {{"map", "-", "-", "-o", "m.bt"}, {"standard input"}},
      {{"map", "-", "--poses", "-", "-o", "m.bt"}, {"standard input"}},
      {{"info"}, {"info: FILE is missing"}},
      {{"info", "a", "b"}, {"unexpected argument 'b'"}},
      {{"info", "--jsn", "a"}, {"did you mean '--json'?"}},
      {{"compare", "a.bt"}, {"compare: B is missing"}},
      {{"compare", "-", "-"}, {"standard input"}},
      {{"convert", "a.csv"}, {"convert: -o FILE is missing"}},
      {{"convert", "a.csv", "-o", "a.png"}, {"pingvox render"}},
      {{"convert", "a.csv", "-o", "a.cvs"}, {"did you mean '.csv'?"}},
      {{"map", "a.csv", "-o", "a.bt", "--device", "Ping360"}, {"--device: ", "did you mean 'ping360'?"}},
      {{"convert", "a.bt", "-o", "a.yml"}, {"did you mean '.yaml'?"}},
      {{"convert", "a.bt", "-o", "-", "--format", "pgm"}, {"-o -", "two files"}},
      {{"convert", "a.csv", "-o", "a.bt", "--echoes"}, {"--echoes", ".csv only"}},
      {{"convert", "a.bt", "-o", "a.yaml", "--height", "lowest"}, {"--height", ".asc"}},
      {{"convert", "a.bt", "-o", "a.asc", "--height", "low"}, {"did you mean 'lowest'?"}},
      {{"convert", "a.bt", "-o", "a.yaml", "--z", "0", "--min-z", "0"}, {"--z: excludes"}},
      {{"map", "log.csv", "-o", "m.bt", "--occupied", "0.4", "--free", "0.6"}, {"--free: must be at most --occupied"}},
      {{"map", "log.csv", "-o", "m.bt", "--cut-depth", "17"}, {"--cut-depth: must be in 1..16"}},
      {{"convert", "a.bt", "-o", "a.yaml", "--min-z", "1", "--max-z", "0"},
       {"the lower end of a slice (1 m) must not be above"}},
      {{"convert", "a.bt", "-o", "a.yaml", "--z", "inf"}, {"finite"}},
      {{"convert", "a.stl", "-o", "a.bt", "--resolution", "0"}, {"resolution"}},
      {{"map", "a.ply", "-o", "a.bt", "--origin", "1,2"}, {"--origin", "3 numbers"}},
      {{"map", "a.ply", "-o", "a.bt", "--origin", "1,2,inf"}, {"--origin", "finite"}},
      {{"render", "a.csv", "-o", "a.jpg"}, {".png"}},
      {{"render", "a.csv", "-o", "a.png", "--threshold", "1000"}, {"threshold"}},
      {{"render", "a.csv", "-o", "a.png", "--view", "abov"}, {"--view", "did you mean 'above'?"}},
      {{"render", "a.csv", "-o", "a.png", "--view", "slice"}, {"--view slice", "--z"}},
      {{"render", "a.csv", "-o", "a.png", "--z", "1"}, {"--z", "--view slice"}},
      {{"render", "a.csv", "-o", "a.png", "--from", "left"}, {"--from", "--view side"}},
      {{"render", "a.csv", "-o", "a.png", "--view", "slice", "--z", "1", "--min-z", "0"}, {"--view slice", "--min-z"}},
      {{"render", "a.csv", "-o", "a.png", "--beside", "--thresold 40"}, {"--beside", "did you mean '--threshold'?"}},
      {{"render", "a.csv", "-o", "a.png", "--beside", "--threshold x"}, {"--beside", "--threshold", "'x'"}},
      {{"render", "a.csv", "-o", "a.png", "--beside", "--caption 'x"}, {"--beside", "quotation mark"}},
      {{"render", "a.csv", "-o", "a.png", "--beside", "b.csv"}, {"--beside", "'b.csv'"}},
      {{"render", "a.csv", "-o", "a.png", "--beside", "-o b.png"}, {"--beside", "-o"}},
      {{"render", "a.csv", "-o", "a.png", "--beside", "--help"}, {"--beside", "--help"}},
      {{"render", "a.csv", "-o", "a.png", "--min-z", "2", "--max-z", "1"},
       {"--min-z must be below --max-z", "2 and 1"}},
      {{"simulate", "tank", "-o", "a.csv", "--range", "0"}, {"--range: must be 0.000399..399 m with 399 bins, is 0 m"}},
      {{"simulate", "harbour", "-o", "a.csv", "--bins", "1"}, {"--bins", "1 m is the longest"}},
      {{"render", "-", "-", "-o", "a.png"}, {"standard input"}},
      {{"simulate", "-o", "a.csv"}, {"WORLD is missing"}},
      {{"simulate", "tnak", "-o", "a.csv"}, {"'tnak'", "did you mean 'tank'?"}},
      {{"simulate", "tank"}, {"-o FILE is missing"}},
      {{"simulate", "tank", "-o", "a.csv", "--seed", "-1"}, {"--seed"}},
      {{"simulate", "tank", "-o", "a.csv", "--turns", "0"}, {"turns"}},
      {{"simulate", "tank", "-o", "a.csv", "--speckle", "2"}, {"speckle"}},
      {{"simulate", "tank", "-o", "a.csv", "--range", "5", "--bin-length", "0.01"}, {"--range and --bin-length"}},
      {{"simulate", "tank", "-o", "a.csv", "--poses", "a.tum", "--trajectory", "loop"}, {"--poses and --trajectory"}},
      {{"simulate", "harbour", "-o", "-", "--trajectory", "loop"}, {"-o -"}},
      {{"simulate", "harbour", "-o", "a.csv", "--trajectory", "lop"}, {"did you mean 'loop'?"}},
      {{"simulate", "harbour", "-o", "a.csv", "--drift", "-1"}, {"--drift: must be 0..1000, is -1"}},
  };
  const Workplace here;
  for (const Case& c : cases) {
    SCOPED_TRACE(::testing::PrintToString(c.words));
    expect_error(here.call(c.words), 2, c.texts);
  }
  EXPECT_THAT(here.files(), ::testing::IsEmpty());
}

// Each of these was accepted and ignored.
TEST(Usage, OptionsWithoutEffectAreRefused) {
  struct Case {
    Args args;
    Args texts;
  };
  const std::vector<Case> cases = {
      {{"map", "a.csv", "-o", "m.bt", "--filter", "none", "--kernel", "7"},
       {"--kernel: has no effect", "--filter none"}},
      {{"map", "a.csv", "-o", "m.bt", "--filter", "median", "--sigma", "2"}, {"--sigma: has no effect", "gaussian"}},
      {{"map", "a.csv", "-o", "m.bt", "--cfar", "ca"}, {"--cfar: has no effect with --detect rise", "--detect cfar"}},
      {{"map", "a.csv", "-o", "m.bt", "--beam", "ray", "--beam-width", "3"}, {"--beam-width: has no effect"}},
      {{"map", "a.csv", "-o", "m.bt", "--beam", "fan", "--beam-height", "3"}, {"--beam-height: has no effect"}},
      {{"map", "a.csv", "-o", "m.bt", "-o", "n.bt"}, {"--output: given twice: 'm.bt' and 'n.bt'"}},
      {{"map", "a.csv", "-o", "m.bt", "--format", "ot"}, {"--format ot: contradicts the suffix of m.bt"}},
      {{"map", "tank.csv", "-o", "m.bt", "--origin", "1,2,3"}, {"--origin: has no effect on logs of beams", "clouds"}},
      {{"map", "tank.csv", "-o", "m.bt", "--ray", "bresenham"},
       {"--ray: has no effect on logs of beams", "--beam ray"}},
      {{"live", "replay:tank.csv", "-o", "m.bt", "--ray", "dda"}, {"--ray: has no effect", "--beam ray"}},
      {{"map", "tank.csv", "-o", "m.bt", "--free", "0.6"}, {"--free: above 0.5 needs --occupied"}},
      {{"map", "a.xyz", "-o", "m.bt", "--beam-width", "3"}, {"--beam-width: has no effect on clouds of points"}},
      {{"info", "a.xyz", "b.xyz"}, {"unexpected argument"}},
      {{"convert", "tank.csv", "-o", "b.csv", "--z", "0"}, {"--z: has no effect on logs of beams"}},
      {{"convert", "tank.csv", "-o", "b.csv", "--threshold", "9"}, {"--threshold: has no effect", "tables of echoes"}},
      {{"render", "tank.csv", "-o", "b.png", "--resolution", "1"},
       {"--resolution: has no effect", "logs drawn as maps (--view above, side, slice)"}},
      {{"render", "tank.csv", "-o", "b.png", "--view", "above", "--sweep", "1"}, {"--sweep: has no effect"}},
      {{"map", "a.csv", "-o", "m.bt", "--nav-offset", "1"}, {"--nav-offset: has no effect without --nav\n"}},
      {{"simulate", "harbour", "-o", "b.csv", "--side", "5"}, {"--side: has no effect with WORLD harbour"}},
      {{"simulate", "harbour", "-o", "b.csv", "--drift", "1"}, {"--drift: has no effect with --trajectory still"}},
      {{"simulate", "harbour", "-o", "b.csv", "--resolution", "1"}, {"--resolution: has no effect without --truth"}},
  };
  const Workplace here;
  here.simulate_tank();
  here.write("a.xyz", "1 2 3\n");
  for (const Case& c : cases) {
    SCOPED_TRACE(::testing::PrintToString(c.args));
    expect_error(here.call(c.args), 2, c.texts);
  }
  EXPECT_THAT(here.files(), ::testing::UnorderedElementsAre("tank.csv", "a.xyz"));
}

// A file of defaults may say more than one call needs.
TEST(Usage, ADefaultOfTheConfigurationFileMayHaveNoEffect) {
  const Workplace here;
  here.simulate_tank();
  here.write("c.toml", "kernel = 7\n");
  const Outcome outcome = here.call({"map", "tank.csv", "-o", "m.bt", "--config", "c.toml", "--filter", "none"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(Usage, EachCommandExplainsItselfWithExamples) {
  const Workplace here;
  for (const std::string command : {"map", "info", "compare", "convert", "render", "simulate"}) {
    SCOPED_TRACE(command);
    const Outcome outcome = here.call({command, "--help"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, HasSubstr("Usage: pingvox " + command));
    EXPECT_THAT(outcome.out, HasSubstr("Examples:\n  pingvox " + command));
    EXPECT_EQ(here.call({"help", command}).out, outcome.out);
    EXPECT_THAT(here.call({"--help"}).out, HasSubstr("\n  " + command + " "));
  }
}

TEST(Usage, TheFirstLineOfHelpShowsTheOptionsThatAreRequired) {
  const Workplace here;
  EXPECT_THAT(here.call({"map", "--help"}).out,
              ::testing::StartsWith("Usage: pingvox map LOG... -o FILE [OPTION]...\n"));
  EXPECT_THAT(here.call({"info", "--help"}).out, ::testing::StartsWith("Usage: pingvox info FILE [OPTION]...\n"));
  EXPECT_THAT(here.call({"locate", "--help"}).out,
              ::testing::StartsWith("Usage: pingvox locate LOG... -o FILE --map FILE [OPTION]...\n"));
}

// A name from inside of the program, or of a stage, says nothing to who typed an option.
TEST(Usage, ANumberOutsideOfItsLimitsIsRefusedByTheNameOfItsOption) {
  struct Case {
    std::string command, option;
    Args good, bad;  ///< the ends of what is allowed (or near them), and what is just outside
  };
  const std::vector<Case> cases = {
      {"map", "--min-range", {"0", "100", "auto"}, {"-0.1", "inf"}},
      {"map", "--max-range", {"0.8", "inf"}, {"0", "-1"}},
      {"map", "--resolution", {"0.0001", "1000"}, {"0", "1001", "1e300", "inf"}},
      {"map", "--sound-speed", {"151", "14999"}, {"150", "15000", "1"}},
      {"map", "--kernel", {"1", "99"}, {"-1", "2", "101"}},
      {"map", "--sigma", {"0.01", "1000"}, {"0", "1001"}},
      {"map", "--hit", {"0.51", "0.99"}, {"0.5", "0.4"}},
      {"map", "--miss", {"0.01", "0.49"}, {"0.5", "0.6"}},
      {"map", "--beam-width", {"0.01", "180"}, {"0", "180.1"}},
      {"map", "--beam-height", {"0.01", "179.9"}, {"0", "180"}},
      {"map", "--free-share", {"0.01", "1"}, {"0", "1.01"}},
      {"map", "--occupied", {"0.01", "0.99"}, {"0", "1"}},
      {"map", "--free", {"0.01", "0.5"}, {"0", "1"}},
      {"map", "--cut-depth", {"1", "16"}, {"0", "129"}},
      {"render", "--size", {"16", "3072"}, {"0", "15", "3073"}},
      {"simulate", "--side", {}, {"0", "0.9", "1001"}},
      {"simulate", "--speed", {"0.01", "100"}, {"0", "101"}},
      {"simulate", "--drift", {"0", "1000"}, {"-1", "1001"}},
      {"simulate", "--heading-drift", {"0", "572.95"}, {"-1", "573"}},
      {"simulate", "--range", {"0.0004", "399"}, {"0", "400", "inf"}},
      {"simulate", "--bins", {"1", "10000"}, {"0", "10001"}},
      {"simulate", "--bin-length", {"0.000001", "1"}, {"0", "1.01"}},
      {"simulate", "--beams-per-turn", {"4", "6400"}, {"3", "6401"}},
      {"simulate", "--beam-width", {"0.01", "57.29"}, {"0", "57.3"}},
      {"simulate", "--beam-height", {"0.01", "114.59"}, {"0", "114.6"}},
      {"simulate", "--side-lobes", {"0", "1"}, {"-0.1", "1.1"}},
      {"simulate", "--gain", {"0", "1"}, {"-0.1", "1.1"}},
      {"simulate", "--compression", {"0.1", "1"}, {"0", "1.1"}},
      {"simulate", "--absorption", {"0", "10"}, {"-0.1", "10.1"}},
      {"simulate", "--ringing", {"0", "10000"}, {"-0.1", "10001"}},
      {"simulate", "--speckle", {"0", "1"}, {"-0.1", "1.1"}},
      {"simulate", "--noise", {"0", "255"}, {"-0.1", "256"}},
      {"simulate", "--multipath", {"0", "1"}, {"-0.1", "1.1"}},
      {"simulate", "--bubbles", {"0", "1"}, {"-0.1", "1.1"}},
      {"simulate", "--lost", {"0", "0.99"}, {"-0.1", "1"}},
  };
  const Workplace here;
  for (const Case& c : cases) {
    const std::string output = c.command == "map" ? "a.bt" : (c.command == "render" ? "a.png" : "a.csv");
    const auto call = [&](const std::string& value) {
      Args args = {c.command, c.option == "--side" ? "tank" : "missing.stl", "-o", output, c.option, value};
      if (c.option.ends_with("drift")) args.insert(args.end(), {"--poses", "missing.stl"});
      if (c.option == "--speed") args.insert(args.end(), {"--trajectory", "line"});
      return here.call(args);
    };
    for (const std::string& value : c.bad) {
      SCOPED_TRACE(c.command + " " + c.option + " " + value);
      const Outcome outcome = call(value);
      expect_error(outcome, 2, {"pingvox: " + c.command + ": " + c.option + ": must be ", ", is " + value});
      EXPECT_EQ(outcome.err.find('_'), std::string::npos) << outcome.err;
    }
    for (const std::string& value : c.good) {
      SCOPED_TRACE(c.command + " " + c.option + " " + value);
      expect_error(call(value), 1, {"missing.stl"});  // the words are right: there is no such file
    }
  }
}

// 1 is no failure there.
TEST(Usage, TheOverviewTellsTheStatusOfCompareApart) {
  EXPECT_THAT(Workplace().call({"--help"}).out, HasSubstr("compare: 0 equal, 1 different, 2 failed"));
}

TEST(Usage, NoArgumentAfterTwoDashesIsAnOption) {
  const Workplace here;
  here.simulate_tank();
  here.write("-tank.csv", here.read("tank.csv"));
  expect_error(here.call({"map", "-o", "tank.bt", "-tank.csv"}), 2, {"unknown option '-tank.csv'"});
  const Outcome outcome = here.call({"map", "-o", "tank.bt", "--", "-tank.csv"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(Usage, ValuesMayBeJoinedToTheirOptions) {
  const Workplace here;
  EXPECT_EQ(here.call({"simulate", "tank", "-oa.csv", "--seed=7", "--turns=1"}).status, 0);
  EXPECT_EQ(here.call({"simulate", "tank", "-o", "b.csv", "--seed", "7", "--turns", "1"}).status, 0);
  EXPECT_EQ(here.read("a.csv"), here.read("b.csv"));
  EXPECT_NE(here.read("a.csv"), "");
  expect_error(here.call({"map", "a.csv", "-o", "a.bt", "--json=true"}), 2, {"--json: takes no value"});
  expect_error(here.call({"map", "a.csv", "-o", "a.bt", "--nav="}), 2, {"--nav: is empty"});
  expect_error(here.call({"map", "a.csv", "-o"}), 2, {"--output: needs a value"});
  expect_error(here.call({"map", "a.csv", "-o", "a.bt", "--kernel", "--quiet"}), 2,
               {"'--quiet' is not a whole number"});
  // An option that may stand without a value takes the next argument only if it is one of its words.
  EXPECT_EQ(here.call({"convert", "a.csv", "--echoes", "-o", "first.csv"}).status, 0);
  EXPECT_EQ(here.call({"convert", "--echoes", "a.csv", "-o", "same.csv"}).status, 0);
  EXPECT_EQ(here.call({"convert", "--echoes", "all", "a.csv", "-o", "all.csv"}).status, 0);
  EXPECT_EQ(here.read("first.csv"), here.read("same.csv"));
  EXPECT_NE(here.read("first.csv"), here.read("all.csv"));
}

TEST(Usage, TheHelpIsGivenWhateverElseIsWrong) {
  const Workplace here;
  for (const Args& args : {Args{"map", "--nonsense", "--help"}, Args{"map", "-h", "--hit", "7"}}) {
    const Outcome outcome = here.call(args);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, ::testing::StartsWith("Usage: pingvox map"));
  }
}

TEST(Usage, VersionIsOneLine) {
  const Outcome outcome = Workplace().call({"--version"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, ::testing::StartsWith("pingvox 0."));
  EXPECT_EQ(outcome.out.find('\n'), outcome.out.size() - 1);
}

TEST(Config, GivesWhatTheCallDoesNotSay) {
  const Workplace here;
  here.simulate_tank();
  here.write("tank.toml",
             "# a comment\nresolution = 0.2\nbeam = \"fan\"\nclamp = [0.12, 0.97]\nmin_range = 0.8\njson = true\n");
  const Outcome by_file = here.call({"map", "tank.csv", "-o", "a.bt", "--config", "tank.toml"});
  EXPECT_EQ(by_file.status, 0) << by_file.err;
  EXPECT_THAT(by_file.out, HasSubstr("\"resolution\": 0.2"));
  const Outcome by_words = here.call({"map", "tank.csv", "-o", "b.bt", "--resolution", "0.2", "--beam", "fan",
                                      "--clamp", "0.12,0.97", "--min-range", "0.8"});
  EXPECT_EQ(by_words.status, 0) << by_words.err;
  EXPECT_EQ(here.read("a.bt"), here.read("b.bt"));
  const Outcome both = here.call({"map", "tank.csv", "-o", "c.bt", "--config", "tank.toml", "--resolution", "0.1"});
  EXPECT_THAT(both.out, HasSubstr("\"resolution\": 0.1"));
}

TEST(Config, WrongWordsInItAreNamedWithTheFile) {
  struct Case {
    std::string content;
    Args texts;
  };
  const std::vector<Case> cases = {
      {"resolutoin = 0.1\n", {"c.toml", "'resolutoin'", "did you mean '--resolution'?"}},
      {"resolution = \"abc\"\n", {"c.toml: line 1: resolution: 'abc' is not a number of metres"}},
      {"# a comment\nresolution = abc\n", {"c.toml: line 2: "}},
      {"depth = 16\ndepth = 16\n", {"c.toml: line 2: ", "'depth'"}},
      {"depth = 16\n\nkernel = 4\n", {"c.toml: line 3: kernel: must be odd, is 4"}},
      {"nav = [[\"a.csv\"]]\n", {"c.toml: line 1: nav: must be a number, a text, true or false, or a list of these"}},
      {"resolution = 2026-01-01\n", {"c.toml: line 1: resolution: must be a number"}},
      {"beam = \"cnoe\"\n", {"c.toml", "did you mean 'cone'?"}},
      {"[map]\nresolution = 0.1\n", {"c.toml: line 1: has a section"}},
      {"depth = 16\n[[map]]\n", {"c.toml: line 2: has a section"}},
      {"config = \"c.toml\"\n", {"c.toml", "'config'"}},
      {"json = 7\n", {"c.toml", "json", "true or false"}},
      {std::string("\x7f\x45\x4c\x46\0\1\2\xff = 3\n", 13), {"c.toml"}},
  };
  const Workplace here;
  for (const Case& c : cases) {
    SCOPED_TRACE(c.content);
    here.write("c.toml", c.content);
    expect_error(here.call({"map", "log.csv", "-o", "m.bt", "--config", "c.toml"}), 2, c.texts);
  }
  expect_error(here.call({"map", "log.csv", "-o", "m.bt", "--config", "no.toml"}), 1, {"no.toml"});
}

}  // namespace
}  // namespace pingvox::test
