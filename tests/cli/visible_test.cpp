// What `compare --visible-from` prints, beside what the bench that made docs/tuning.md measures.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "accuracy/ground_truth.hpp"
#include "call.hpp"
#include "json_reader.hpp"

namespace pingvox::test {
namespace {

FlatJson compared(const Workplace& here, const std::vector<std::string>& more) {
  std::vector<std::string> words = {"compare",        "map.ot",          "truth/world.bt",
                                    "--visible-from", "truth/poses.tum", "--json"};
  words.insert(words.end(), more.begin(), more.end());
  const Outcome outcome = here.call(words);
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  return flat_json(outcome.out).value_or(FlatJson{});
}

void expect_same(FlatJson json, const MapAgreement& score) {
  EXPECT_NEAR(std::stod(json["against_b.precision"]), score.precision().value_or(-1.0), 1e-9);
  EXPECT_NEAR(std::stod(json["against_b.recall"]), score.recall().value_or(-1.0), 1e-9);
  EXPECT_NEAR(std::stod(json["against_b.free_true"]), score.free_true().value_or(-1.0), 1e-9);
  EXPECT_NEAR(std::stod(json["against_b.free_true_1_cell"]), score.free_true_near().value_or(-1.0), 1e-9);
  EXPECT_EQ(json["against_b.visible"], std::to_string(score.to_find));
}

TEST(CompareVisible, PrintsWhatTheBenchMeasures) {
  PINGVOX_SKIP_WITH_OTHER_PROGRAM();
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "harbour", "-o", "log.csv", "--turns", "2", "--truth", "truth", "--quiet"}).status,
            0);
  ASSERT_EQ(here.call({"map", "log.csv", "-o", "map.ot", "--quiet"}).status, 0);
  const auto recording = bench::record({.world = "harbour", .motion = Motion::kStill, .turns = 2});
  ASSERT_TRUE(recording);
  BeamModelOptions cone;
  cone.shape = BeamShape::kCone;
  const auto map = bench::map_echoes(*recording, bench::detect(*recording, {}, {}), cone, 0.05);
  ASSERT_TRUE(map);
  const auto plane = bench::GroundTruth::make(*recording, bench::Extent::kPlane, 0.05, 0.75);
  ASSERT_TRUE(plane);
  expect_same(compared(here, {"--max-range", "10", "--layer", "0"}), *plane->score(*map));
  const auto space = bench::GroundTruth::make(*recording, bench::Extent::kSpace, 0.05, 0.75);
  ASSERT_TRUE(space);
  expect_same(compared(here, {"--max-range", "10"}), *space->score(*map));
}

TEST(CompareVisible, SaysWhenNothingOfTheTruthCouldBeSeen) {
  const Workplace here;
  ASSERT_EQ(here.call({"simulate", "tank", "-o", "log.csv", "--turns", "1", "--truth", "truth", "--quiet"}).status, 0);
  here.write("far.tum", "0 500 0 0 0 0 0 1\n");
  expect_error(
      here.call({"compare", "truth/world.bt", "truth/world.bt", "--visible-from", "far.tum", "--max-range", "10"}), 2,
      {"far.tum: nothing of truth/world.bt could be seen"});
}

TEST(CompareVisible, RefusesItsOptionsWithoutIt) {
  const Workplace here;
  expect_error(here.call({"compare", "a.bt", "b.bt", "--max-range", "10"}), 2, {"--max-range", "--visible-from"});
  expect_error(here.call({"compare", "a.bt", "b.bt", "--visible-from", "t", "--max-range", "0.5"}), 2,
               {"--max-range: must be above --min-range (0.75 m), is 0.5 m"});
}

}  // namespace
}  // namespace pingvox::test
