#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "call.hpp"

using namespace pingvox::test;
using ::testing::HasSubstr;

namespace {

struct Size {
  unsigned width = 0, height = 0;
};

/// Of a PNG, from its header.
Size size_of(const std::string& png) {
  if (!png.starts_with("\x89PNG\r\n") || png.size() < 24) return {};
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<unsigned char>(png[i]);
    return value;
  };
  return {number(16), number(20)};
}

/// Calls `render` with these words and gives the picture's bytes.
std::string rendered(const Workplace& here, std::vector<std::string> words, const Streams& streams = {}) {
  words.insert(words.begin(), "render");
  words.insert(words.end(), {"-o", "picture.png"});
  const Outcome outcome = here.call(words, streams);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return here.read("picture.png");
}

TEST(Render, EachViewIsAnotherPicture) {
  const Workplace here;
  here.simulate_tank();
  const std::vector<std::vector<std::string>> views = {{},
                                                       {"--view", "cartesian"},
                                                       {"--view", "cartesian", "--between", "nothing"},
                                                       {"--view", "cartesian", "--show", "filtered"},
                                                       {"--view", "cartesian", "--echoes", "off"},
                                                       {"--view", "above"},
                                                       {"--view", "side"},
                                                       {"--view", "side", "--from", "behind"},
                                                       {"--view", "slice", "--z", "0"}};
  std::vector<std::string> pictures;
  for (std::vector<std::string> words : views) {
    SCOPED_TRACE(::testing::PrintToString(words));
    words.insert(words.end(), {"tank.csv", "--size", "200"});
    pictures.push_back(rendered(here, words));
    EXPECT_GT(size_of(pictures.back()).width, 200U);
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i) EXPECT_NE(pictures.back(), pictures[i]) << i;
  }
}

TEST(Render, ALogIsDrawnAsTheMapThatItMakes) {
  const Workplace here;
  here.simulate_tank();
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "tank.pvx", "--beam", "fan", "--threshold", "40"}).status, 0);
  EXPECT_EQ(rendered(here, {"tank.csv", "--view", "above", "--beam", "fan", "--threshold", "40"}),
            rendered(here, {"tank.pvx"}));
}

// Beams without a pose were left out of the picture without a word.
TEST(Render, SaysWhatOfALogIsNotOnThePicture) {
  const Workplace here;
  here.simulate_tank();
  here.write("short.tum", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
  const Outcome drawn = here.call(
      {"render", "tank.csv", "-o", "p.png", "--view", "above", "--poses", "short.tum", "--resolution", "0.2"});
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(drawn.err, HasSubstr(" beams outside the time of the poses, 0.000 s to 1.000 s"));
}

TEST(Render, DrawsTrajectoriesOverAMap) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "dive.csv", "--trajectory", "loop", "--turns", "2", "--drift", "1",
                       "--truth", "truth", "--resolution", "0.1"})
                .status,
            0);
  const std::string map = "truth/world.bt";
  const std::string none = rendered(here, {map});
  const std::string one = rendered(here, {map, "--path", "truth/poses.tum"});
  const std::string two = rendered(here, {map, "--path", "truth/poses.tum", "--path", "dive.tum"});
  EXPECT_GT(size_of(one).height, size_of(none).height) << "with a legend";
  EXPECT_GT(size_of(two).height, size_of(one).height);
  EXPECT_NE(rendered(here, {map, "--path", "dive.tum", "--beside", "--path truth/poses.tum"}), one);
  expect_error(here.call({"render", map, "-o", "a.png", "--path", "none.tum"}), 1, {"none.tum"});
  expect_error(here.call({"render", map, "-o", "a.png", "--path", "dive.csv"}), 1, {"dive.csv", "not a trajectory"});
  expect_error(here.call({"render", "dive.csv", "-o", "a.png", "--path", "dive.tum"}), 2, {"--path"});
  expect_error(here.call({"render", map, "-o", "a.png", "--z", "0"}), 2,
               {"--z: has no effect here, only on --view slice"});
}

TEST(Render, SettingsStandSideBySide) {
  const Workplace here;
  here.simulate_tank();
  const Size one = size_of(rendered(here, {"tank.csv", "--view", "above", "--size", "300"}));
  const Size two = size_of(
      rendered(here, {"tank.csv", "--view", "above", "--size", "300", "--beside", "--filter none --threshold 60"}));
  EXPECT_GE(two.width, 2 * one.width);
  EXPECT_GT(two.height, one.height);  // by the captions
  const Outcome four = here.call({"render", "tank.csv", "tank.csv", "-o", "four.png", "--size", "200", "--title", "All",
                                  "--beside", "--caption 'as it is, filtered' --show filtered", "--quiet"});
  EXPECT_EQ(four.status, 0) << four.err;
  const Outcome three = here.call(
      {"render", "tank.csv", "-o", "three.png", "--size", "200", "--beside", "--sweep 1", "--beside", "--sweep 2"});
  EXPECT_THAT(three.out, HasSubstr("three.png: 3 pictures"));
  // The same setting in a configuration file.
  here.write("pair.toml", "view = \"above\"\nsize = 300\nbeside = [\"--filter none --threshold 60\"]\n");
  EXPECT_EQ(
      rendered(here, {"tank.csv", "--config", "pair.toml"}),
      rendered(here, {"tank.csv", "--view", "above", "--size", "300", "--beside", "--filter none --threshold 60"}));
}

TEST(Render, ReadsStandardInputOnceForAllPanels) {
  const Workplace here;
  here.simulate_tank();
  EXPECT_EQ(rendered(here, {"-", "--size", "200", "--beside", "--view cartesian"}, {.in = here.read("tank.csv")}),
            rendered(here, {"tank.csv", "--size", "200", "--beside", "--view cartesian"}));
}

// Kills a picture of the short pings that a head was tried with before the dive.
TEST(Render, ACartesianPictureShowsTheSweepThatSeesMost) {
  const Workplace here;
  std::string log = "time_s,bearing_deg,bin_length_m,intensities\n";
  for (int i = 0; i < 400; ++i) log += fmt::format("{},{},0.001,0,9,9\n", i, i % 400 * 0.9);
  for (int i = 400; i < 700; ++i) log += fmt::format("{},{},1,0,9,9\n", i, i % 400 * 0.9);
  here.write("dive.csv", log);
  EXPECT_EQ(rendered(here, {"dive.csv", "--view", "cartesian"}),
            rendered(here, {"dive.csv", "--view", "cartesian", "--sweep", "2"}));
}

// Kills leaves that are drawn as a whole where the limits cut them.
TEST(Render, HeightsBeyondTheLimitsAreNotDrawnFromTheSide) {
  const Workplace here;
  here.simulate_tank();
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "tank.ot"}).status, 0);
  ASSERT_EQ(here.call({"convert", "tank.ot", "-o", "coarse.ot", "--cut-depth", "12"}).status, 0);
  ASSERT_EQ(here.call({"convert", "coarse.ot", "-o", "layers.ot", "--min-z", "-0.2", "--max-z", "0.2"}).status, 0);
  EXPECT_EQ(rendered(here, {"coarse.ot", "--view", "side", "--min-z", "-0.2", "--max-z", "0.2"}),
            rendered(here, {"layers.ot", "--view", "side"}));
}

// Kills a picture of a map without its agreement, and one of a log that is of its sweeps.
TEST(Render, AgreementIsDrawnOnTheMapOfALog) {
  const Workplace here;
  here.simulate_tank();
  const Outcome drawn = here.call({"render", "tank.csv", "-o", "agreement.png", "--show", "agreement"});
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(drawn.out, HasSubstr("the map from above (it predicts "));
  EXPECT_NE(here.read("agreement.png"), rendered(here, {"tank.csv", "--view", "above"}));
  EXPECT_EQ(here.read("agreement.png"), rendered(here, {"tank.csv", "--show", "agreement", "--view", "above"}));
  EXPECT_NE(here.read("agreement.png"), rendered(here, {"tank.csv", "--show", "agreement", "--view", "side"}));
  EXPECT_NE(rendered(here, {"tank.csv", "--beside", "--show agreement"}), "");

  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "tank.bt"}).status, 0);
  expect_error(here.call({"render", "tank.bt", "-o", "p.png", "--show", "agreement"}), 2,
               {"--show: has no effect", "logs drawn as maps"});
  expect_error(here.call({"render", "tank.csv", "-o", "p.png", "--show", "agreement", "--view", "polar"}), 2,
               {"--show: has no effect", "logs drawn as maps"});
  expect_error(here.call({"render", "tank.csv", "-o", "p.png", "--show", "raw", "--view", "above"}), 2,
               {"--show: has no effect", "--view polar"});
}

TEST(Render, SaysWhatAFileHasNoPictureOf) {
  const Workplace here;
  here.simulate_tank();
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "tank.bt"}).status, 0);
  expect_error(here.call({"render", "tank.bt", "-o", "p.png", "--view", "polar"}), 2, {"tank.bt", "a map"});
  expect_error(here.call({"render", "tank.csv", "-o", "p.png", "--view", "cartesian", "--sweep", "99"}), 2,
               {"tank.csv", "no sweep 99"});
  expect_error(here.call({"render", "tank.csv", "-o", "p.png", "--view", "above", "--poses", "none.tum"}), 1,
               {"none.tum"});
  expect_error(here.call({"render", "tank.csv", "-o", "p.png", "--max-range", "0.5"}), 2,
               {"--max-range: must be above --min-range"});
  EXPECT_FALSE(here.has("p.png"));
}

}  // namespace
