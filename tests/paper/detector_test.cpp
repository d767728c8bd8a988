// Section 8.2 of the paper: a threshold on the difference of two bins.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "bench/paper/paper_detector.hpp"
#include "bench/paper/tank_logs.hpp"

namespace pingvox::bench {
namespace {

/// One beam of 40 bins of 10 cm, as a sweep.
Sweep sweep_of(std::vector<std::uint8_t> bins) {
  bins.resize(40, bins.back());
  Sweep sweep;
  sweep.beams.push_back({.time_s = 0.0, .bearing_rad = 0.0, .bin_length_m = 0.1, .intensities = std::move(bins)});
  return sweep;
}

std::vector<std::optional<Echo>> echoes_of(const Sweep& sweep) {
  return detect_echoes(PolarImage(sweep), sweep, {.min_range_m = 0.3, .threshold = 70});
}

TEST(PaperDetector, AsWrittenTakesTheEndOfTheRingingForAWall) {
  // The ringing ends at 0.5 m, the wall is at 2 m.
  std::vector<std::uint8_t> bins(20, 10);
  std::fill_n(bins.begin(), 5, std::uint8_t{120});
  bins.insert(bins.end(), {110, 100, 10});
  const auto edge = paper_edge(bins, 3, 70);
  ASSERT_TRUE(edge);
  EXPECT_EQ(edge->bin, 5U);
  EXPECT_TRUE(edge->is_falling);
  const auto echo = echoes_of(sweep_of(bins)).front();
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->first, 20U);
}

TEST(PaperDetector, AsWrittenMissesAWallThatRisesOverSomeBins) {
  std::vector<std::uint8_t> bins(20, 10);
  bins.insert(bins.end(), {40, 70, 100, 120, 100, 60, 10});
  EXPECT_FALSE(paper_edge(bins, 3, 70));
  EXPECT_TRUE(echoes_of(sweep_of(bins)).front());
}

TEST(PaperDetector, CountsAStepEqualToTheThresholdAndNothingBeforeTheFirstBin) {
  const std::vector<std::uint8_t> bins = {0, 200, 0, 0, 69, 139, 0};
  const auto edge = paper_edge(bins, 2, 70);
  ASSERT_TRUE(edge);
  EXPECT_EQ(edge->bin, 5U);
  EXPECT_FALSE(edge->is_falling);
  EXPECT_FALSE(paper_edge({}, 0, 1));
}

// In the authors' program a beam without an edge has its wall in its last bin. In open water that is a ring of walls.
TEST(PaperDetector, ASilentBeamIsNoWallAtTheEndOfItsRange) {
  const Sweep sweep = sweep_of({10});
  ASSERT_FALSE(paper_edge(sweep.beams.front().intensities, 0, 70));
  ASSERT_FALSE(echoes_of(sweep).front());
  const auto occupied = [&](const std::optional<Echo>& echo, Silent silent) {
    OccupancyMap map;
    ScanUpdate scan(map.lattice());
    trace_beam(Pose::Identity(), sweep.beams.front(), echo,
               {.shape = BeamShape::kRay, .hit_from = HitFrom::kFixed, .silent = silent}, scan);
    EXPECT_TRUE(map.apply(scan));
    return map.counts().occupied_cells;
  };
  const Echo last{.first = 39, .peak = 39, .last = 39, .range_m = 3.95, .intensity = 10};
  EXPECT_EQ(occupied(last, Silent::kNothing), 1U) << "what the authors' program does";
  EXPECT_EQ(occupied(std::nullopt, Silent::kNothing), 0U);
  EXPECT_EQ(occupied(std::nullopt, Silent::kFree), 0U);
}

TEST(PaperDetector, FindsThresholdSeventyBestWhenDifferencesAreSummed) {
  const auto logs = tank_logs();
  ASSERT_TRUE(logs);
  for (const TankLog& log : *logs) {
    SCOPED_TRACE(log.name);
    const auto right = [&](int threshold) { return judge_echoes(log, {}, {.threshold = threshold}).right; };
    for (const int other : {20, 40, 140}) EXPECT_GT(right(70), right(other)) << other;
    std::size_t found = 0;
    for (const Sweep& sweep : log.sweeps) {
      const PolarImage image = apply_filter(PolarImage(sweep), {});
      for (std::size_t n = 0; n < image.rows(); ++n) {
        found += paper_edge(image.row(n).first(image.bins_in(n)), 60, 70) ? 1U : 0U;
      }
    }
    EXPECT_EQ(found, 0U) << "of the smoothed beams none has a single difference of 70";
  }
}

}  // namespace
}  // namespace pingvox::bench
