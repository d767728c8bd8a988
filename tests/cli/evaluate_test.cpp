// How far a map can be believed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

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
