#include "pingvox/recording/evaluate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <sstream>
#include <vector>

#include "pingvox/io/tum.hpp"
#include "recording/dive.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

FileBytes tum_of(const Trajectory& trajectory) {
  std::ostringstream out;
  EXPECT_TRUE(write_tum(trajectory, out));
  return {"dive.tum", bytes_of(out.str())};
}

/// A head that stands still in a tank.
FileBytes tank_log(std::size_t turns) {
  SonarOptions sonar;
  sonar.beams_per_turn = 100;
  sonar.bins = 300;
  sonar.bin_length_m = 0.03;
  SonarSimulator beams(tank_scene({}).world, Trajectory::still(Pose::Identity()), sonar, turns);
  std::ostringstream log;
  EXPECT_TRUE(write_csv(beams, log));
  return {"tank.csv", bytes_of(log.str())};
}

Evaluation evaluation_of(const FileBytes& log, const RecordingOptions& options = {}, const EvaluateOptions& how = {}) {
  const auto recording = Recording::open({log}, options);
  EXPECT_TRUE(recording);
  const Result<Evaluation> found = evaluate(*recording, how);
  EXPECT_TRUE(found) << found.error().message;
  return found.value_or(Evaluation{});
}

EchoCounts sum_of(const std::vector<Evaluation::Part>& parts) {
  EchoCounts sum;
  for (const Evaluation::Part& part : parts) {
    sum.echoes += part.counts.echoes;
    sum.judged += part.counts.judged;
    sum.within_cell += part.counts.within_cell;
    sum.within_10cm += part.counts.within_10cm;
    sum.predicted += part.counts.predicted;
    sum.too_early += part.counts.too_early;
    sum.from_free += part.counts.from_free;
  }
  return sum;
}

void expect_equal(const EchoCounts& a, const EchoCounts& b) {
  EXPECT_EQ(a.echoes, b.echoes);
  EXPECT_EQ(a.judged, b.judged);
  EXPECT_EQ(a.within_cell, b.within_cell);
  EXPECT_EQ(a.within_10cm, b.within_10cm);
  EXPECT_EQ(a.predicted, b.predicted);
  EXPECT_EQ(a.too_early, b.too_early);
  EXPECT_EQ(a.from_free, b.from_free);
}

TEST(Evaluate, CountsEachEchoOnceByRangeByTimeAndInAll) {
  const Evaluation found = evaluation_of(tank_log(4));
  EXPECT_EQ(found.beams, 400U);
  EXPECT_EQ(found.folds, 4U);
  EXPECT_TRUE(found.is_judged());
  EXPECT_GT(found.all.echoes, 350U);
  EXPECT_EQ(found.all.judged, found.all.predicted + found.all.too_early + found.all.from_free);
  EXPECT_GT(found.all.predicted * 100, found.all.judged * 85);
  EXPECT_LE(found.all.within_cell, found.all.within_10cm);
  expect_equal(sum_of(found.by_range), found.all);
  expect_equal(sum_of(found.by_time), found.all);
  // One part begins where the one before ends.
  for (const auto* parts : {&found.by_range, &found.by_time}) {
    for (std::size_t i = 0; i < parts->size(); ++i) {
      EXPECT_LT((*parts)[i].from, (*parts)[i].to);
      EXPECT_TRUE(i == 0 || (*parts)[i].from >= (*parts)[i - 1].to);
    }
  }
  for (std::size_t i = 1; i < found.by_time.size(); ++i) EXPECT_EQ(found.by_time[i].from, found.by_time[i - 1].to);
}

// Kills a map of one sweep that is judged by itself, and cells coarser than a decimetre that are not the tolerance.
TEST(Evaluate, OneSweepCannotBeJudged) {
  const Evaluation found = evaluation_of(tank_log(1));
  EXPECT_FALSE(found.is_judged());
  EXPECT_EQ(found.all.coverage(), 0.0);
  EXPECT_EQ(found.sweeps.places_heard_once, found.sweeps.places);
  EXPECT_EQ(evaluation_of(tank_log(2), {}, {.map = {.resolution_m = 0.3}}).tolerance_m, 0.3);
}

// Kills an evaluation along another path than the map's.
TEST(Evaluate, ATrueTrajectoryIsBetterThanAStillVehicle) {
  const Dive dive = harbour_dive();
  const EvaluateOptions coarse{.map = {.resolution_m = 0.1}};
  const Evaluation moving = evaluation_of(dive.log, {.poses = tum_of(dive.truth)}, coarse);
  const Evaluation still = evaluation_of(dive.log, {}, coarse);
  EXPECT_GT(moving.sweeps.moved_m, 0.1);
  EXPECT_EQ(still.sweeps.moved_m, 0.0);
  EXPECT_GT(moving.all.predicted, still.all.predicted);
}

TEST(Evaluate, RefusesScansAndOptionsThatAreOutOfRange) {
  const auto recording = Recording::open({FileBytes{"cloud.xyz", bytes_of("1 2 3\n4 5 6\n")}});
  ASSERT_TRUE(recording);
  const auto of_scans = evaluate(*recording);
  ASSERT_FALSE(of_scans);
  EXPECT_EQ(of_scans.error().code, Error::Code::kUnsupported);
  const Result<void> valid = EvaluateOptions{.map = {.resolution_m = -1.0}, .folds = 1}.validate();
  ASSERT_FALSE(valid);
  EXPECT_EQ(valid.error().code, Error::Code::kBadOption);
  EXPECT_THAT(valid.error().message, HasSubstr("folds must be in 2..1000, is 1"));
  EXPECT_THAT(valid.error().message, HasSubstr("resolution"));
}

}  // namespace
}  // namespace pingvox::test
