#include "sonar/noise_floor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"

namespace pingvox {
namespace {

using Bins = std::vector<std::uint8_t>;

constexpr std::size_t kBins = 400;
constexpr double kMicronBin_m = 0.125;

/// Rayleigh noise, the amplitude of many small echoes, on a background; both grow with the range.
Bins noise_by_range(std::mt19937_64& random) {
  Bins bins(kBins);
  for (std::size_t i = 0; i < kBins; ++i) {
    const double farther = static_cast<double>(i) / kBins,
                 share = (static_cast<double>(random() % 1'000'000) + 1.0) / 1'000'001.0;
    const double amplitude = 4.0 + 24.0 * farther * farther;
    bins[i] = static_cast<std::uint8_t>(std::min(amplitude * std::sqrt(-2.0 * std::log(share)), 255.0));
  }
  return bins;
}

void add_wall(Bins& bins, std::size_t bin, int height) {
  for (std::size_t i = bin; i < bin + 8; ++i) bins[i] = static_cast<std::uint8_t>(std::min(bins[i] + height, 255));
}

Sweep turn_with(std::vector<Bins> beams) {
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = {}};
  for (Bins& bins : beams) sweep.beams.push_back({.bin_length_m = kMicronBin_m, .intensities = std::move(bins)});
  return sweep;
}

std::vector<std::optional<Echo>> echoes_in(const Sweep& sweep) {
  return detect_echoes(apply_filter(PolarImage(sweep), {}), sweep, {});
}

std::vector<NoiseFloor> floors_in(const Sweep& sweep) {
  const PolarImage image = apply_filter(PolarImage(sweep), {});
  std::vector<BinWindow> windows;
  for (std::size_t n = 0; n < image.rows(); ++n) windows.push_back({0, image.bins_in(n)});
  const NoiseFloors floors(image, windows);
  std::vector<NoiseFloor> all;
  for (std::size_t n = 0; n < image.rows(); ++n) all.push_back(floors.of(n));
  return all;
}

// Kills thresholds of one height for all of a beam: the far noise rises as much as the near wall.
TEST(NoiseFloor, KeepsFarNoiseFromBeingEchoesBesideANearWall) {
  std::size_t near = 0, far = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<Bins> beams;
    for (std::size_t n = 0; n < 200; ++n) {
      beams.push_back(noise_by_range(random));
      if (n % 40 < 20) add_wall(beams.back(), 120, 60);
    }
    const auto echoes = echoes_in(turn_with(std::move(beams)));
    for (std::size_t n = 0; n < echoes.size(); ++n) {
      if (!echoes[n]) continue;
      const bool is_wall = std::abs(static_cast<double>(echoes[n]->peak) - 124.0) < 8.0;
      ++(is_wall ? near : far);
    }
  }
  EXPECT_GE(near, 500U);
  EXPECT_LE(far, 15U);
}

// Kills a floor where a wall is: it would hide the parts of it that answer faintly.
TEST(NoiseFloor, IsNoneWhereTheBeamsAroundHearAWall) {
  std::mt19937_64 random(3);
  std::vector<Bins> beams;
  for (std::size_t n = 0; n < 99; ++n) {
    beams.push_back(noise_by_range(random));
    if (n % 33 < 9) add_wall(beams.back(), 225, 200);
  }
  for (const NoiseFloor& floor : floors_in(turn_with(std::move(beams)))) {
    EXPECT_EQ(floor.at(225), 0);
    EXPECT_GT(floor.at(399), 0);
  }
}

// Kills a wall that is taken for noise.
TEST(NoiseFloor, DoesNotTakeALoudWallForNoise) {
  std::mt19937_64 random(5);
  for (const std::size_t wall : {230U, 355U}) {
    std::vector<Bins> quiet, beams;
    for (std::size_t n = 0; n < 100; ++n) {
      quiet.push_back(noise_by_range(random));
      beams.push_back(quiet.back());
      // Long and rough: more than half of the part's bins. Heard by few, so that the floor stays.
      for (std::size_t i = wall; i < wall + 40 && i < kBins; ++i) {
        beams.back()[i] = static_cast<std::uint8_t>(60 + 20 * (random() % 8));
      }
    }
    const NoiseFloor before = floors_in(turn_with(std::move(quiet)))[50],
                     after = floors_in(turn_with(std::move(beams)))[50];
    EXPECT_EQ(after.at(wall + 20), 0);
    EXPECT_LE(after.at(120), before.at(120));
  }
}

// Kills a wall in the first part of the beams that is taken for noise, which no part before limits: its echo fills the
// part, and its second echo would be the wall.
TEST(NoiseFloor, DoesNotTakeTheSlopesOfALongNearEchoForNoise) {
  std::mt19937_64 random(13);
  std::vector<Bins> beams;
  for (std::size_t n = 0; n < 33; ++n) {
    Bins bins(kBins);
    for (std::size_t i = 0; i < kBins; ++i) {
      const double slope = i < 4    ? 0.0
                           : i < 22 ? (static_cast<double>(i) - 4.0) / 18.0
                                    : (40.0 - static_cast<double>(i)) / 18.0;
      bins[i] = static_cast<std::uint8_t>(120.0 * std::max(slope, 0.0) + static_cast<double>(random() % 8));
    }
    beams.push_back(std::move(bins));
  }
  for (const NoiseFloor& floor : floors_in(turn_with(std::move(beams)))) EXPECT_LE(floor.at(20), 60);
}

// Kills a floor that takes noise from beams that are shorter by their bin instead of their share of the range.
TEST(NoiseFloor, FollowsEachBeamsOwnRange) {
  std::mt19937_64 random(7);
  std::vector<Bins> beams;
  for (std::size_t n = 0; n < 60; ++n) {
    const Bins all = noise_by_range(random);
    if (n % 4 != 0) {
      beams.push_back(all);
      continue;
    }
    Bins half;
    for (std::size_t i = 0; i < kBins; i += 2) half.push_back(all[i]);
    beams.push_back(std::move(half));
  }
  const std::vector<NoiseFloor> floors = floors_in(turn_with(std::move(beams)));
  EXPECT_NEAR(floors[20].at(199), floors[21].at(399), 0.4 * floors[21].at(399));
  EXPECT_GT(floors[20].at(199), 2 * floors[20].at(0));
}

// Kills beams at the seam of a turn that do not look across it.
TEST(NoiseFloor, TurnsWithTheBeamsOfATurn) {
  std::mt19937_64 random(11);
  std::vector<Bins> beams;
  for (std::size_t n = 0; n < 100; ++n) {
    beams.push_back(noise_by_range(random));
    if (n < 30) add_wall(beams.back(), 200, 150);
  }
  const std::vector<NoiseFloor> before = floors_in(turn_with(beams));
  std::rotate(beams.begin(), beams.begin() + 37, beams.end());
  const std::vector<NoiseFloor> after = floors_in(turn_with(beams));
  for (std::size_t n = 0; n < before.size(); ++n) {
    for (std::size_t bin = 0; bin < kBins; bin += 25) {
      ASSERT_EQ(after[n].at(bin), before[(n + 37) % before.size()].at(bin)) << n << ", " << bin;
    }
  }
}

}  // namespace
}  // namespace pingvox
