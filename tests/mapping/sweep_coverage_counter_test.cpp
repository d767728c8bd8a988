// What sweeps heard, counted in bounded memory.
#include "mapping/sweep_coverage_counter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "pingvox/geometry/pose.hpp"

namespace pingvox {
namespace {

constexpr double kCell_m = 0.05, kWidth_rad = 0.01;

/// A beam along x, 2 m long, of a head at `x_m`.
PlacedBeam beam_at(double x_m) {
  PlacedBeam beam{.map_from_sensor = pose_from_rpy({x_m + 0.2, 0.2, 0.0}, 0.0, 0.0, 0.0),
                  .bin_length_m = 0.02,
                  .bins = 200,
                  .echo = Echo()};
  beam.echo->range_m = 2.0;
  return beam;
}

// Kills a sample that keeps the first or the last values only, or that grows.
TEST(ThinnedSample, IsSpreadOverAllValues) {
  detail::ThinnedSample<double> sample;
  constexpr std::size_t kMany = 1'000'000;
  std::size_t largest = 0;
  for (std::size_t i = 0; i < kMany; ++i) {
    sample.add(static_cast<double>(i));
    largest = std::max(largest, sample.values().size());
  }
  EXPECT_EQ(sample.count(), kMany);
  EXPECT_LE(largest, 20'000U);
  const std::vector<double>& values = sample.values();
  ASSERT_GT(values.size(), 5'000U);
  EXPECT_EQ(values.front(), 0.0);
  for (std::size_t i = 1; i < values.size(); ++i) EXPECT_EQ(values[i] - values[i - 1], values[1] - values[0]);
  EXPECT_GT(values.back() + (values[1] - values[0]), static_cast<double>(kMany - 1));
}

TEST(ThinnedSample, KeepsAllOfFewValues) {
  detail::ThinnedSample<int> sample;
  for (int i = 0; i < 10'000; ++i) sample.add(i);
  EXPECT_EQ(sample.values().size(), 10'000U);
}

// Medians of a long run are those of its complete sweeps, and each place is counted once a sweep.
TEST(SweepCoverageCounter, CountsALongRun) {
  detail::SweepCoverageCounter counter(kCell_m);
  constexpr std::size_t kSweeps = 50'000;
  for (std::size_t sweep = 0; sweep < kSweeps; ++sweep) {
    const double start_s = 10.0 * static_cast<double>(sweep);
    for (int beam = 0; beam < 3; ++beam) counter.add(start_s + beam, beam_at(0.001 * beam), kWidth_rad, true);
    // Each fourth is cut off.
    counter.end_sweep(sweep % 4 != 0);
  }
  counter.add(1e9, beam_at(0.0), kWidth_rad, true);
  const SweepCoverage coverage = counter.coverage();
  EXPECT_EQ(coverage.sweeps, kSweeps) << "without the one that has not ended";
  EXPECT_EQ(coverage.echoes, 3 * kSweeps + 1);
  EXPECT_LE(coverage.places, 2U);
  EXPECT_EQ(coverage.places_heard_once, 0U);
  EXPECT_NEAR(coverage.sweeps_per_place, static_cast<double>(kSweeps), 1.0);
  EXPECT_EQ(coverage.sweep_s, 2.0);
  EXPECT_NEAR(coverage.moved_m, 0.002, 1e-9);
  EXPECT_NEAR(coverage.beam_width_m, 2.0 * kWidth_rad, 1e-12);
}

// Kills turns that add up: a vehicle that rolls to and fro does not turn.
TEST(SweepCoverageCounter, ARockingVehicleDoesNotTurnFar) {
  detail::SweepCoverageCounter counter(kCell_m);
  constexpr double kRock_rad = 0.1;
  for (int beam = 0; beam < 100; ++beam) {
    PlacedBeam placed = beam_at(0.0);
    placed.map_from_sensor = pose_from_rpy({0, 0, 0}, beam % 2 == 0 ? 0.0 : kRock_rad, 0.0, 0.0);
    counter.add(beam, placed, kWidth_rad, true);
  }
  counter.end_sweep(true);
  EXPECT_NEAR(counter.coverage().turned_rad, kRock_rad, 1e-9);
}

TEST(SweepCoverageCounter, HasThePausesOfTheHead) {
  detail::SweepCoverageCounter counter(kCell_m);
  for (int beam = 0; beam < 100; ++beam) {
    counter.add(0.1 * beam + (beam < 50 ? 0.0 : 7.0), beam_at(0.0), kWidth_rad, true);
    if (beam == 20) counter.end_sweep(true);
  }
  EXPECT_EQ(counter.coverage().pauses.count, 1U);
  EXPECT_NEAR(counter.coverage().pauses.total_s, 7.1, 1e-9);
}

// Kills places without end: those of a vehicle that goes on and on.
TEST(SweepCoverageCounter, HasAMillionPlacesAtMost) {
  detail::SweepCoverageCounter counter(kCell_m);
  constexpr int kPlaces = 1'050'000;
  for (int i = 0; i < kPlaces; ++i) {
    counter.add(i, beam_at(0.5 * i), 0.0, true);
    if (i % 100 == 99) counter.end_sweep(true);
  }
  // Those that are known count on.
  counter.add(kPlaces, beam_at(0.0), 0.0, true);
  counter.end_sweep(true);
  const SweepCoverage coverage = counter.coverage();
  EXPECT_EQ(coverage.places, 1'000'000U);
  EXPECT_EQ(coverage.places_heard_once, 999'999U);
}

}  // namespace
}  // namespace pingvox
