// Questions to maps, and sums of maps.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// A head in a tank of 3 by 4 m, mapped in cells of 5 cm.
void map_tank(const Workplace& here) {
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "tank.csv", "--turns", "3", "--seed", "1"}).status, 0);
  ASSERT_EQ(here.call({"map", "tank.csv", "-o", "tank.ot"}).status, 0);
}

TEST(Query, AnswersForEachPlaceInTheirOrder) {
  const Workplace here;
  map_tank(here);
  const Outcome points = here.call({"query", "tank.ot", "--point", "0.5,0,0", "--point", "50,0,0"});
  ASSERT_EQ(points.status, 0) << points.err;
  EXPECT_THAT(points.out, StartsWith("x,y,z,state,probability\n0.500000,0.000000,0.000000,free,0."));
  EXPECT_THAT(points.out, HasSubstr("\n50.000000,0.000000,0.000000,unknown,\n"));
  // What is named first, then the lines of standard input.
  const Outcome nearest = here.call({"query", "tank.ot", "--nearest", "0,0,0", "--nearest", "-", "--json"},
                                    {.in = "# poses\n0.5 0 0\n\n1,\t0,0\r\n"});
  ASSERT_EQ(nearest.status, 0) << nearest.err;
  EXPECT_THAT(nearest.out, HasSubstr("\"point\": [0, 0, 0]"));
  EXPECT_THAT(nearest.out, HasSubstr("\"point\": [1, 0, 0]"));
  EXPECT_THAT(nearest.out, HasSubstr("\"state\": \"occupied\""));
}

// A ray and the nearest point of a wall agree with the tank's walls.
TEST(Query, RaysAndRangesEndAtTheWalls) {
  const Workplace here;
  map_tank(here);
  const auto ray = flat_json(here.call({"query", "tank.ot", "--ray", "0,0,0,1,0,0", "--json"}).out);
  ASSERT_TRUE(ray);
  const Outcome near = here.call({"query", "tank.ot", "--nearest", "0,0,0", "--max-range", "0.1"});
  EXPECT_THAT(near.out, HasSubstr("0.000000,0.000000,0.000000,nothing,,,,\n"));
  const Outcome blocked = here.call({"query", "tank.ot", "--ray", "0,0,0,0,0,1", "--unknown", "block"});
  EXPECT_THAT(blocked.out, HasSubstr(",unknown,"));
  const Outcome region = here.call({"query", "tank.ot", "--region", "-9,-9,-9,9,9,9"});
  const auto counts = flat_json(here.call({"info", "tank.ot", "--json"}).out);
  ASSERT_TRUE(counts);
  EXPECT_THAT(region.out, HasSubstr("," + counts->at("occupied_cells") + "," + counts->at("free_cells") + ","));
}

// Files that other programs and this one write.
TEST(Query, TakesPosesAndItsOwnTables) {
  const Workplace here;
  map_tank(here);
  const Outcome poses = here.call({"query", "tank.ot", "--nearest", "-"}, {.in = "0.5 0 0 0 0 0 0 1\n"});
  ASSERT_EQ(poses.status, 0) << poses.err;
  EXPECT_EQ(poses.out, here.call({"query", "tank.ot", "--nearest", "0,0,0"}).out);
  const Outcome named = here.call({"query", "tank.ot", "--point", "-"}, {.in = "x,y,z\n0,0,0.5\n"});
  ASSERT_EQ(named.status, 0) << named.err;
  EXPECT_THAT(named.out, HasSubstr("0.000000,0.000000,0.500000,"));
}

TEST(Query, SaysWhereNothingIsKnown) {
  const Workplace here;
  map_tank(here);
  const Outcome far = here.call({"query", "tank.ot", "--point", "1e9,0,0"});
  EXPECT_EQ(far.status, 0);
  EXPECT_THAT(far.err, HasSubstr("no place is within what tank.ot knows"));
  EXPECT_EQ(here.call({"query", "tank.ot", "--point", "0,0,0"}).err, "");
  // A ray that meets nothing has no range.
  const Outcome ray = here.call({"query", "tank.ot", "--ray", "0,0,0,0,0,1"});
  EXPECT_THAT(ray.out, HasSubstr(",nothing,,,,\n"));
}

TEST(Query, RefusesWhatItCannotAnswer) {
  const Workplace here;
  map_tank(here);
  const auto error_of = [&](std::vector<std::string> args, std::string in = {}) {
    args.insert(args.begin(), {"query", "tank.ot"});
    const Outcome outcome = here.call(args, {.in = std::move(in)});
    EXPECT_NE(outcome.status, 0);
    EXPECT_TRUE(outcome.out.empty());
    return outcome.err;
  };
  EXPECT_THAT(error_of({}), HasSubstr("a question is missing"));
  EXPECT_THAT(error_of({"--point", "1,2"}), HasSubstr("must be 3 numbers, X,Y,Z"));
  EXPECT_THAT(error_of({"--point", "1,2,inf"}), HasSubstr("'inf' is not finite"));
  EXPECT_THAT(error_of({"--ray", "0,0,0,0,0,0"}), HasSubstr("has no direction"));
  EXPECT_THAT(error_of({"--point", "0,0,0", "--nearest", "0,0,0"}),
              HasSubstr("--point and --nearest: one kind of question at a time"));
  EXPECT_THAT(error_of({"--point", "0,0,0", "--max-range", "3"}), HasSubstr("--max-range"));
  EXPECT_THAT(error_of({"--point", "-"}, "0 0 0\n1 2\n"), HasSubstr("standard input: line 2: '1 2'"));
}

TEST(Merge, AddsTwoMapsOfOnePlace) {
  const Workplace here;
  map_tank(here);
  ASSERT_EQ(here.call({"merge", "tank.ot", "tank.ot", "-o", "sum.ot"}).status, 0);
  const Outcome compared = here.call({"compare", "sum.ot", "tank.ot", "--json"});
  const auto same = flat_json(compared.out);
  ASSERT_TRUE(same) << compared.err;
  EXPECT_EQ(same->at("only_a"), "0");
  EXPECT_EQ(same->at("only_b"), "0");
  EXPECT_EQ(same->at("against_b.precision"), "1");
}

TEST(Merge, MovesAMapToItsPlace) {
  const Workplace here;
  map_tank(here);
  ASSERT_EQ(here.call({"merge", "tank.ot", "-o", "there.pvx", "--at", "tank.ot=10,0,0,0,0,90"}).status, 0);
  // What was ahead is to the left of the new place.
  const auto wall_of = [&](const std::string& map, const std::string& ray) {
    return here.call({"query", map, "--ray", ray}).out;
  };
  const std::string before = wall_of("tank.ot", "0.01,0.01,0.01,1,0,0");
  const std::string after = wall_of("there.pvx", "9.99,0.01,0.01,0,1,0");
  ASSERT_THAT(before, HasSubstr(",occupied,"));
  EXPECT_EQ(before.substr(before.find(",occupied,"), 18), after.substr(after.find(",occupied,"), 18));
  EXPECT_THAT(here.call({"merge", "tank.ot", "there.pvx", "-o", "both.ot"}).err,
              HasSubstr("there.pvx: has no place in common with the maps before it"));
  const Outcome coarse =
      here.call({"merge", "tank.ot", "there.pvx", "-o", "coarse.bt", "--resolution", "0.2", "--json"});
  const auto json = flat_json(coarse.out);
  ASSERT_TRUE(json) << coarse.err;
  EXPECT_EQ(json->at("maps"), "2");
  EXPECT_EQ(json->at("map.resolution"), "0.2");
  EXPECT_NE(json->at("map.occupied_cells"), "0");
}

TEST(Merge, RefusesMapsThatAreNotThere) {
  const Workplace here;
  map_tank(here);
  EXPECT_THAT(here.call({"merge", "tank.ot", "-o", "a.ot", "--at", "other.ot=0,0,0,0,0,0"}).err,
              HasSubstr("'other.ot' is not one of the maps (tank.ot)"));
  EXPECT_THAT(here.call({"merge", "tank.csv", "-o", "a.ot"}).err, HasSubstr("not a map"));
  EXPECT_EQ(here.call({"merge", "tank.ot", "-o", "tank.ot"}).status, 2);
}

}  // namespace
}  // namespace pingvox::test
