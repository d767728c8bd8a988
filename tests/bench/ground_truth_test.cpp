// Ground truth and scores, compared with closed forms and with deliberate errors.
#include "accuracy/ground_truth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "bench/tank_range.hpp"
#include "pingvox/analysis/compare.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/mapping/build_map.hpp"

namespace pingvox::bench {
namespace {

Recording tank(std::size_t turns) {
  return *record({.world = "tank", .motion = Motion::kStill, .turns = turns});
}

TEST(TrueReturns, OnTheAxisAreTheTanksOwnFormula) {
  const Recording recording = tank(2);
  const std::vector<TrueReturns> truths = true_returns(recording);
  ASSERT_EQ(truths.size(), 400U);
  for (std::size_t n = 0; n < truths.size(); ++n) {
    SCOPED_TRACE(n);
    ASSERT_TRUE(truths[n].axis_m);
    EXPECT_NEAR(*truths[n].axis_m, true_range_m({}, recording.pings[n].bearing_rad), 1e-9);
    ASSERT_FALSE(truths[n].returns.empty());
    EXPECT_LE(truths[n].lobe.front().first_m, truths[n].returns.front().first_m + 0.02);
  }
}

TEST(TrueReturns, OverABottomBeginAtTheLowerEdgeOfTheCone) {
  const Recording recording = *record({.world = "harbour", .motion = Motion::kStill, .turns = 1});
  const std::vector<TrueReturns> truths = true_returns(recording);
  const TrueReturns& right = truths[50];  // clockwise by 90 degrees: out of the harbour's mouth
  EXPECT_FALSE(right.axis_m);
  // Three metres below, 7 m to the mouth: behind it there is no bottom, so the cone hears none and the lobe some.
  EXPECT_TRUE(right.returns.empty());
  const TrueReturns& left = truths[150];
  ASSERT_TRUE(left.axis_m);
  EXPECT_NEAR(*left.axis_m, 7.0, 0.01);
  EXPECT_NEAR(left.returns.front().first_m, 7.0, 0.02);
  EXPECT_NEAR(left.returns.back().last_m, 7.0 / std::cos(17.5 * kDegree_rad), 0.1);
}

TEST(Mapped, IsWhatBuildMapMakes) {
  const Recording recording = tank(2);
  std::vector<Beam> beams;
  for (const Sweep& sweep : recording.sweeps) beams.insert(beams.end(), sweep.beams.begin(), sweep.beams.end());
  BeamsInMemory source(std::move(beams));
  OccupancyMap built(MapOptions{.resolution_m = 0.05});
  ASSERT_TRUE(build_map(source, Trajectory::still(Pose::Identity()), {}, built));
  const auto map = map_echoes(recording, detect(recording, {}, {}), {}, 0.05);
  ASSERT_TRUE(map);
  const auto same = compare_maps(built, *map, Sameness::kLogOdds);
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->equal());
  EXPECT_GT(same->cells(), 1000U);
}

class OfPerfectRanges : public testing::Test {
 protected:
  MapAgreement score_of(double bias_m) const {
    Echoes echoes = true_echoes(recording_, truths_, 0.75);
    for (std::optional<Echo>& echo : echoes) {
      if (!echo) continue;
      echo->range_m += bias_m;
      echo->first = static_cast<std::size_t>(echo->range_m / recording_.sonar.bin_length_m);
    }
    return *world_->score(*map_echoes(recording_, echoes, {.shape = BeamShape::kRay}, 0.05));
  }

  Recording recording_ = tank(2);
  std::vector<TrueReturns> truths_ = true_returns(recording_);
  Result<GroundTruth> world_ = GroundTruth::make(recording_, Extent::kPlane, 0.05, 0.75);
};

TEST_F(OfPerfectRanges, AMapInThePlaneIsRight) {
  ASSERT_TRUE(world_);
  const MapAgreement score = score_of(0.0);
  EXPECT_EQ(score.precision(), 1.0);
  EXPECT_GT(score.recall(), 0.98);
  EXPECT_GT(score.free_true(), 0.99);
  EXPECT_EQ(score.free_true_near(), 1.0);
  EXPECT_GT(score.to_find, 300U);
}

TEST_F(OfPerfectRanges, ABiasOfThreeCellsIsSeenInEachMeasure) {
  ASSERT_TRUE(world_);
  const MapAgreement behind = score_of(0.15);
  EXPECT_LT(behind.precision(), 0.2);
  EXPECT_LT(behind.recall(), 0.2);
  EXPECT_LT(behind.free_true_near(), 0.99);  // the wall itself is freed, and what is behind
  const MapAgreement before = score_of(-0.15);
  EXPECT_LT(before.precision(), 0.2);
  EXPECT_GT(before.free_true(), 0.999);  // hardly anything but water was passed
}

TEST(Recorded, RefusesAnUnknownWorld) {
  EXPECT_FALSE(record({.world = "moon"}));
}

}  // namespace
}  // namespace pingvox::bench
