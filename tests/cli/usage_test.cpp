// Valid and invalid command lines.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "call.hpp"
#include "suggest.hpp"

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

TEST(Usage, VersionIsOneLine) {
  const Outcome outcome = Workplace().call({"--version"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, ::testing::StartsWith("pingvox 0."));
  EXPECT_EQ(outcome.out.find('\n'), outcome.out.size() - 1);
}

TEST(Usage, TheViewerOfLaterVersionsIsNoSpellingMistake) {
  expect_error(Workplace().call({"view", "a.bt"}), 1, {"not in this version", "pingvox render"});
}

/// All long options in a text.
std::set<std::string> options_in(const std::string& text) {
  std::set<std::string> options;
  for (std::size_t at = 0; (at = text.find("--", at)) != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at), text.size());
    if (end > at + 2) options.insert(text.substr(at, end - at));
    at = end;
  }
  return options;
}

/// The options that the man page has an entry for, by command.
std::map<std::string, std::set<std::string>> man_page_entries(const std::string& page) {
  std::map<std::string, std::set<std::string>> entries;
  std::string command, before;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line); before = line) {
    if (line.starts_with(".SS \"pingvox "))
      command = line.substr(13, line.find(' ', 13) - 13);
    else if (line.starts_with(".S"))
      command.clear();
    if (!command.empty() && before == ".TP") entries[command].merge(options_in(line));
  }
  return entries;
}

/// The options that a help text has an entry for: lines as in `  -o, --output FILE     what it is`.
std::set<std::string> help_entries(const std::string& help) {
  std::set<std::string> entries;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t dash = line.find("--");
    const bool is_entry = line.starts_with("      --") || (line.starts_with("  -") && dash == 6);
    if (is_entry) entries.insert(*options_in(line.substr(0, line.find(' ', dash))).begin());
  }
  entries.erase("--help");
  return entries;
}

// Kills an option that the page only mentions, or that it describes after the program lost it.
TEST(Usage, TheManPageHasTheEntriesOfTheHelpAndNoOther) {
  const Workplace here;
  std::filesystem::copy_file(PINGVOX_SOURCE_DIR "/docs/man/pingvox.1", here.folder() / "page");
  std::string page = here.read("page");
  std::erase(page, '\\');  // \- is how roff spells a dash
  std::map<std::string, std::set<std::string>> described = man_page_entries(page);
  std::size_t checked = 0;
  for (const std::string command :
       {"map", "info", "compare", "convert", "render", "simulate", "slam", "locate", "live", "emulate"}) {
    std::set<std::string> of_help = help_entries(here.call({command, "--help"}).out);
    checked += of_help.size();
    if (command == "render" || command == "slam" || command == "locate" ||
        command == "live") {  // the page sends the reader to those of map
      for (const std::string& option : described["map"]) {
        if (!described[command].contains(option)) of_help.erase(option);
      }
    }
    EXPECT_EQ(described[command], of_help) << command;
  }
  EXPECT_GT(checked, 100U);
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
      {"resolution = \"abc\"\n", {"c.toml", "resolution", "'abc' is not a number"}},
      {"beam = \"cnoe\"\n", {"c.toml", "did you mean 'cone'?"}},
      {"[map]\nresolution = 0.1\n", {"c.toml", "section"}},
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

TEST(NearestWord, IsTheOneThatWasMeantOrNone) {
  using app::nearest_word;
  const Args words = {"--resolution", "--min-range", "--max-range", "--ray", "map", "none"};
  EXPECT_EQ(nearest_word("--resoluton", words), "--resolution");
  EXPECT_EQ(nearest_word("--reslution", words), "--resolution");
  EXPECT_EQ(nearest_word("--min_range", words), "--min-range");
  EXPECT_EQ(nearest_word("-ray", words), "--ray");
  EXPECT_EQ(nearest_word("amp", words), "map");
  EXPECT_EQ(nearest_word("--reso", words), "--resolution");
  EXPECT_EQ(nearest_word("gaussian", words), std::nullopt);
  EXPECT_EQ(nearest_word("", words), std::nullopt);
  EXPECT_EQ(nearest_word(std::string(100'000, 'a'), words), std::nullopt);
}

}  // namespace
}  // namespace pingvox::test
