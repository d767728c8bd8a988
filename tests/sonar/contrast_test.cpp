#include "sonar/contrast.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "pingvox/sonar/detect_echo.hpp"
#include "sonar/beam_rises.hpp"

namespace pingvox {
namespace {

Sweep turn_of(const std::vector<std::vector<std::uint8_t>>& beams) {
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = {}};
  for (const auto& bins : beams) sweep.beams.push_back({.bin_length_m = 0.05, .intensities = bins});
  return sweep;
}

std::vector<int> contrasts_in(const Sweep& sweep) {
  const PolarImage image(sweep);
  std::vector<BinWindow> windows;
  for (std::size_t n = 0; n < image.rows(); ++n) windows.push_back({0, image.bins_in(n)});
  const Contrasts contrasts(image, windows);
  std::vector<int> all;
  for (std::size_t n = 0; n < image.rows(); ++n) all.push_back(contrasts.of(n));
  return all;
}

// Kills a rise that is measured over a bin more or less.
TEST(Contrast, IsHalfOfWhatRisesOverItsBins) {
  constexpr int kSlope = 3;
  std::vector<std::uint8_t> bins(200, 5);
  for (std::size_t i = 70; i < bins.size(); ++i) {
    bins[i] = static_cast<std::uint8_t>(5 + kSlope * static_cast<int>(std::min<std::size_t>(i - 70, 60)));
  }
  const std::vector<int> contrasts = contrasts_in(turn_of({40, bins}));
  EXPECT_EQ(contrasts, std::vector<int>(40, kSlope * static_cast<int>(kRise_bins) / 2));
}

// Kills beams at the seam of a turn that do not look across it.
TEST(Contrast, TurnsWithTheBeamsOfATurn) {
  std::mt19937_64 random(11);
  std::vector<std::vector<std::uint8_t>> beams;
  for (int n = 0; n < 100; ++n) {
    beams.emplace_back(200, std::uint8_t{5});
    std::fill_n(beams.back().begin() + 100, 5, static_cast<std::uint8_t>(30 + 2 * n + static_cast<int>(random() % 20)));
  }
  const std::vector<int> before = contrasts_in(turn_of(beams));
  std::rotate(beams.begin(), beams.begin() + 37, beams.end());
  std::vector<int> after = contrasts_in(turn_of(beams));
  std::rotate(after.begin(), after.end() - 37, after.end());
  EXPECT_EQ(after, before);
}

// Kills a contrast that noise alone reaches.
TEST(Contrast, IsMoreThanNoiseAloneRises) {
  std::size_t echoes = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<std::vector<std::uint8_t>> beams(50, std::vector<std::uint8_t>(400));
    for (auto& bins : beams) {
      for (std::uint8_t& bin : bins) {
        // Rayleigh, the amplitude of many small echoes.
        const double share = (static_cast<double>(random() % 1'000'000) + 1.0) / 1'000'001.0;
        bin = static_cast<std::uint8_t>(std::min(12.0 * std::sqrt(-2.0 * std::log(share)), 255.0));
      }
    }
    const Sweep sweep = turn_of(beams);
    for (const Detector detector : {Detector::kRise, Detector::kMax}) {
      const EchoOptions options{.detector = detector, .min_range_m = 0.5};
      for (const auto& echo : detect_echoes(PolarImage(sweep), sweep, options)) echoes += echo ? 1U : 0U;
    }
  }
  EXPECT_LE(echoes, 5U);
}

}  // namespace
}  // namespace pingvox
