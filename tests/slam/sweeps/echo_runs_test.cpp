// Runs of bins in sweeps that were thresholded and in sweeps with intensities.

#include "slam/sweeps/echo_runs.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include "pingvox/sonar/polar_image.hpp"

namespace pingvox::test {
namespace {

/// One beam of 100 bins of 0.1 m, with runs [first, last] of one intensity.
Sweep one_beam(std::initializer_list<std::pair<std::size_t, std::size_t>> runs) {
  Sweep sweep;
  sweep.beams.push_back({1.0, 0.5, 0.1, std::vector<std::uint8_t>(100, 0)});
  for (const auto& [first, last] : runs) {
    for (std::size_t i = first; i <= last; ++i) sweep.beams[0].intensities[i] = 255;
  }
  return sweep;
}

TEST(EchoRuns, OfAThresholdedBeamAreItsTwoLongest) {
  const auto runs = echo_runs(one_beam({{20, 24}, {40, 50}, {70, 77}}), {}, {});
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_NEAR(runs[0].range_m, 4.55, 1e-12);
  EXPECT_NEAR(runs[0].half_length_m, 0.55, 1e-12);
  EXPECT_NEAR(runs[1].range_m, 7.4, 1e-12);
  EXPECT_EQ(runs[1].time_s, 1.0);
  EXPECT_EQ(runs[1].bearing_rad, 0.5);
}

TEST(EchoRuns, CrossShortGapsAndLeaveOutSpecksAndRinging) {
  const auto runs = echo_runs(one_beam({{2, 6}, {30, 31}, {34, 36}, {60, 61}}), {}, {});
  ASSERT_EQ(runs.size(), 1U) << "2..6 is nearer than 0.75 m, 60..61 has two bins";
  EXPECT_NEAR(runs[0].range_m, 3.35, 1e-12);
  EXPECT_NEAR(runs[0].half_length_m, 0.35, 1e-12);
}

TEST(EchoRuns, AreWithinTheRangesOfTheOptions) {
  EchoOptions echo;
  echo.max_range_m = 5.0;
  echo.min_bin = 25;
  const auto runs = echo_runs(one_beam({{10, 20}, {30, 35}, {60, 70}}), {}, echo);
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_NEAR(runs[0].range_m, 3.3, 1e-12);
}

TEST(EchoRuns, OfIntensitiesAreTheDetectedEchoes) {
  Sweep sweep;
  for (int n = 0; n < 40; ++n) {
    Beam beam{0.1 * n, 0.05 * n, 0.1, std::vector<std::uint8_t>(200, 10)};
    for (std::size_t i = 0; i < 10; ++i) beam.intensities[100 + i] = static_cast<std::uint8_t>(40 + 20 * i);
    sweep.beams.push_back(std::move(beam));
  }
  const auto runs = echo_runs(sweep, {}, {});
  ASSERT_EQ(runs.size(), 40U);
  for (const EchoRun& run : runs) EXPECT_NEAR(run.range_m, 10.7, 0.5);
}

TEST(EchoRuns, OfIntensitiesAreWhereTheCrestIs) {
  Sweep sweep;
  for (int n = 0; n < 40; ++n) {
    Beam beam{0.1 * n, 0.05 * n, 0.1, std::vector<std::uint8_t>(200, 10)};
    // A long rise that is cut off behind its crest.
    for (std::size_t i = 0; i < 30; ++i) beam.intensities[100 + i] = static_cast<std::uint8_t>(40 + 6 * i);
    sweep.beams.push_back(std::move(beam));
  }
  const auto echoes = detect_echoes(apply_filter(PolarImage(sweep), {}), sweep, {});
  const auto runs = echo_runs(sweep, {}, {});
  ASSERT_EQ(runs.size(), 40U);
  ASSERT_TRUE(echoes[20]);
  EXPECT_EQ(runs[20].place, EchoRun::Place::kCrest);
  EXPECT_EQ(runs[20].range_m, echoes[20]->range_m);
  const double middle_m = 0.05 * static_cast<double>(echoes[20]->first + echoes[20]->last + 1);
  EXPECT_GT(runs[20].range_m, middle_m + 0.4) << "else the test sees no difference";
  EXPECT_EQ(echo_runs(one_beam({{20, 24}}), {}, {})[0].place, EchoRun::Place::kMiddle);
}

}  // namespace
}  // namespace pingvox::test
