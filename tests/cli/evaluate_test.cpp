// How far a map can be believed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Evaluate, SaysInOneSentenceHowManyEchoesAMapPredicts) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "a.csv", "--turns", "3", "--seed", "1"}).status, 0);
  const Outcome found = here.call({"evaluate", "a.csv"});
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_THAT(found.out, testing::ContainsRegex("verdict +predicts [0-9]+ % of the echoes it can judge"));
  EXPECT_THAT(found.out, HasSubstr("within 0.1 m"));
  // A still head in a tank is the easiest of all.
  const auto json = flat_json(here.call({"evaluate", "a.csv", "--json"}).out);
  ASSERT_TRUE(json);
  for (const char* key : {"beams", "judged", "within_cell", "within_10cm", "too_early", "from_free", "unknown",
                          "coverage", "by_range", "by_time", "verdict"}) {
    EXPECT_TRUE(json->contains(key)) << key;
  }
  EXPECT_EQ(json->at("beams"), "600");
  EXPECT_GT(std::stod(json->at("within_10cm")), 0.9);
  EXPECT_GT(std::stod(json->at("coverage")), 0.98);
}

TEST(Evaluate, SaysWhyAMapCannotBeJudged) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "a.csv", "--turns", "1"}).status, 0);
  EXPECT_THAT(here.call({"evaluate", "a.csv"}).out, HasSubstr("cannot be judged: there is one sweep only"));
}

// Kills a low share without a word on what it may come from, and a vehicle that is said to make 0 m where nobody knows.
TEST(Evaluate, SaysWhatALowShareMayComeFrom) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "a.csv", "--trajectory", "loop", "--turns", "4"}).status, 0);
  const Outcome still = here.call({"evaluate", "a.csv"});
  EXPECT_THAT(still.out, HasSubstr("come from where the map is free; did the vehicle move (--nav, --poses)?"));
  EXPECT_THAT(still.out, HasSubstr("the vehicle does not move, or its path is unknown"));
  EXPECT_THAT(still.err, HasSubstr("did not move; its trajectory may be --poses a.tum"));
  const Outcome along = here.call({"evaluate", "a.csv", "--poses", "a.tum"});
  EXPECT_THAT(along.out, Not(HasSubstr("come from where")));
  EXPECT_THAT(along.out, HasSubstr("in which the vehicle moves "));
  EXPECT_THAT(along.err, Not(HasSubstr("did not move")));
}

// Kills a number of echoes that is said to be too few of themselves.
TEST(Evaluate, SaysThatThereAreTooFewEchoes) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "a.csv", "--turns", "2"}).status, 0);
  EXPECT_THAT(here.call({"evaluate", "a.csv", "--min-range", "3.2"}).out,
              testing::ContainsRegex("cannot be judged: only [0-9]+ echoes can be judged, too few for a verdict"));
}

// Kills options of map that are taken without effect, and words that are not its own.
TEST(Evaluate, TakesTheOptionsOfMapAndNoOutput) {
  const Workplace here;
  here.simulate_tank();
  const Outcome ray = here.call({"evaluate", "tank.csv", "--beam", "ray", "--resolution", "0.1", "--folds", "2"});
  EXPECT_EQ(ray.status, 0) << ray.err;
  EXPECT_EQ(here.call({"evaluate", "tank.csv", "-o", "a.bt"}).status, 2);
  EXPECT_EQ(here.call({"evaluate", "tank.csv", "--folds", "1"}).status, 2);
  const Outcome cone = here.call({"evaluate", "tank.csv", "--ray", "dda"});
  EXPECT_EQ(cone.status, 2);
  EXPECT_THAT(cone.err, HasSubstr("evaluate: --ray"));
}

}  // namespace
}  // namespace pingvox::test
