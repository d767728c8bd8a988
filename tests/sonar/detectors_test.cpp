// What the detectors beside kRise find, what they leave alone, and thresholds that follow the gain.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "sonar/canny.hpp"
#include "sonar/cfar.hpp"
#include "sonar/contrast.hpp"
#include "support/tank_recording.hpp"

namespace pingvox {
namespace {

constexpr double kBinLength_m = 0.1;
constexpr std::array kDetectors = {Detector::kRise, Detector::kLevel, Detector::kMax, Detector::kCanny,
                                   Detector::kCfar};

using Bins = std::vector<std::uint8_t>;

/// A turn of beams that all heard the same.
Sweep even_turn_of(const Bins& bins, std::size_t beams = 40) {
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = std::vector<Beam>(beams)};
  for (Beam& beam : sweep.beams) {
    beam.bin_length_m = kBinLength_m;
    beam.intensities = bins;
  }
  return sweep;
}

EchoOptions options_of(Detector detector, std::optional<int> threshold = std::nullopt) {
  return {.detector = detector, .min_range_m = 0.0, .threshold = threshold};
}

std::vector<std::optional<Echo>> echoes_of(const Sweep& sweep, const EchoOptions& options) {
  return detect_echoes(PolarImage(sweep), sweep, options);
}

std::optional<Echo> echo_in(const Bins& bins, const EchoOptions& options) {
  const auto echoes = echoes_of(even_turn_of(bins), options);
  for (const auto& echo : echoes) EXPECT_EQ(echo.has_value(), echoes[0].has_value());
  return echoes[0];
}

/// Noise, and a wall like those of the tank: some ten bins wide.
Bins noisy_wall(std::mt19937_64& random, std::size_t bins, double wall, double height) {
  Bins out(bins);
  for (std::size_t i = 0; i < bins; ++i) {
    const double off = (static_cast<double>(i) - wall) / 3.0;
    out[i] = static_cast<std::uint8_t>(height * std::exp(-0.5 * off * off) + static_cast<double>(random() % 12));
  }
  return out;
}

TEST(Level, IsTheFirstBinThatReachesItAlsoOnAFallingEdge) {
  const auto echo = echo_in({0, 0, 30, 59, 60, 90, 0, 200, 0}, options_of(Detector::kLevel, 60));
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->first, 4U);
  EXPECT_EQ(echo->peak, 5U);
  EXPECT_EQ(echo->last, 5U);
  EXPECT_EQ(echo_in({60, 0, 200}, options_of(Detector::kLevel, 60))->first, 0U);
  EXPECT_FALSE(echo_in({59, 0, 59}, options_of(Detector::kLevel, 60)));
}

TEST(Max, IsTheStrongestBinWithTheRunAroundItEvenBehindAnother) {
  const auto echo = echo_in({0, 150, 0, 0, 190, 200, 195, 0, 0}, options_of(Detector::kMax, 60));
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->first, 4U);
  EXPECT_EQ(echo->peak, 5U);
  EXPECT_EQ(echo->last, 6U);
  // Smoothed within the run by 1 4 6 4 1: 3085, 3125 and 3135 sixteenths; 8 * 60 below the highest weighs nothing.
  constexpr std::array<double, 3> weights = {430, 470, 480};
  const double crest =
      (weights[0] * 4.5 + weights[1] * 5.5 + weights[2] * 6.5) / (weights[0] + weights[1] + weights[2]);
  EXPECT_NEAR(echo->range_m, 0.1 * (crest - 1.0), 1e-12);
  EXPECT_EQ(echo_in({0, 200, 0, 200, 0}, options_of(Detector::kMax, 60))->peak, 1U) << "the nearest of two equal ones";
  EXPECT_FALSE(echo_in({0, 59, 0}, options_of(Detector::kMax, 60)));
}

TEST(Canny, IsTheFirstRisingEdge) {
  // 40 a bin: the gradient is 4 * 2 * 40 on the ramp.
  const Bins ramp{0, 0, 0, 40, 80, 120, 120, 120, 120, 0, 0, 0};
  const auto echo = echo_in(ramp, options_of(Detector::kCanny, 300));
  ASSERT_TRUE(echo);
  EXPECT_GE(echo->first, 3U);
  EXPECT_LE(echo->first, 5U);
  EXPECT_EQ(echo->intensity, 120);
  EXPECT_FALSE(echo_in(ramp, options_of(Detector::kCanny, 320))) << "not more than the threshold";
  EXPECT_FALSE(echo_in({200, 200, 200, 0, 0, 0, 0}, options_of(Detector::kCanny, 100))) << "a falling edge";
}

TEST(Canny, LinksWeakEdgesToStrongOnesAcrossTheSeamAndNoFartherThanTheLink) {
  Sweep sweep = even_turn_of(Bins(20, 0));
  // A wall in all beams, strong only in the last three.
  for (std::size_t n = 0; n < 40; ++n) {
    std::fill(sweep.beams[n].intensities.begin() + 10, sweep.beams[n].intensities.end(), n >= 37 ? 100 : 60);
  }
  EchoOptions options = options_of(Detector::kCanny, 350);
  options.canny.link = 5;
  const auto echoes = echoes_of(sweep, options);
  std::vector<std::size_t> found;
  for (std::size_t n = 0; n < 40; ++n) {
    if (echoes[n]) found.push_back(n);
  }
  EXPECT_THAT(found, testing::ElementsAre(0, 1, 2, 3, 4, 5, 31, 32, 33, 34, 35, 36, 37, 38, 39))
      << "the step from beam 36 to 37, and from 39 to 0, makes their neighbours strong too";
  sweep.extent = Sweep::Extent::kSector;
  EXPECT_FALSE(echoes_of(sweep, options)[0]) << "the ends of a sector are no neighbours";
  options.canny.low = 300;
  EXPECT_FALSE(echoes_of(sweep, options)[35]) << "too weak to be linked";
}

TEST(Canny, FindsNoFartherEdgeWithALongerLink) {
  std::size_t edges = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Sweep sweep = even_turn_of(Bins(30, 0), 24);
    for (Beam& beam : sweep.beams)
      beam.intensities = noisy_wall(random, 30, 12.0 + static_cast<double>(random() % 6), 120.0);
    const PolarImage image(sweep);
    const std::vector<BinWindow> windows(24, {2, 28});
    const auto near = first_edges(image, windows, std::vector<int>(24, 150), {.low = 20, .link = 1});
    const auto far = first_edges(image, windows, std::vector<int>(24, 150), {.low = 20, .link = 200});
    const auto all = first_edges(image, windows, std::vector<int>(24, 20), {.low = 20, .link = 1});
    for (std::size_t n = 0; n < 24; ++n) {
      // More link, more edges, so the first one can only come nearer; none are there that are not local maxima.
      if (near[n]) {
        ASSERT_TRUE(far[n]);
        EXPECT_LE(*far[n], *near[n]);
        ++edges;
      }
      if (far[n]) {
        ASSERT_TRUE(all[n]);
        EXPECT_LE(*all[n], *far[n]);
      }
    }
  }
  EXPECT_GT(edges, 1000U);
}

TEST(Cfar, LetsTheWantedShareOfRayleighNoisePass) {
  using Noise = CfarOptions::Noise;
  for (const Noise noise : {Noise::kCellAveraging, Noise::kSmallestOf, Noise::kGreatestOf, Noise::kOrdered}) {
    for (const double rate : {0.05, 0.01}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(noise) << ", " << rate);
      const CfarOptions options{.noise = noise, .guard = 2, .training = 12, .false_alarm_rate = rate};
      const double scale = cfar_scale(options);
      std::mt19937_64 random(7);
      const auto uniform = [&random] { return (static_cast<double>(random() % 1'000'000) + 0.5) / 1e6; };
      std::size_t tested = 0;
      std::size_t passed = 0;
      Bins bins(60);
      while (tested < 60'000) {
        for (std::uint8_t& bin : bins) {
          bin = static_cast<std::uint8_t>(std::min(255.0, 50.0 * std::sqrt(-std::log(uniform()))));
        }
        // The bin in the middle alone, made a rise whatever stands before it.
        const double middle = bins[30];
        bins[29] = 0;
        const std::span<const std::uint8_t> all(bins);
        std::vector<double> squares;
        for (std::size_t i = 16; i < 28; ++i) squares.push_back(bins[i] * bins[i]);
        for (std::size_t i = 33; i < 45; ++i) squares.push_back(bins[i] * bins[i]);
        const double before = std::accumulate(squares.begin(), squares.begin() + 12, 0.0) / 12.0;
        const double behind = std::accumulate(squares.begin() + 12, squares.end(), 0.0) / 12.0;
        std::ranges::sort(squares);
        const double level = noise == Noise::kCellAveraging ? 0.5 * (before + behind)
                             : noise == Noise::kSmallestOf  ? std::min(before, behind)
                             : noise == Noise::kGreatestOf  ? std::max(before, behind)
                                                            : squares[17];
        const bool above = middle > scale * std::sqrt(level);
        passed += above ? 1U : 0U;
        ++tested;
        // The detector says the same of it, when nothing before it passes.
        const auto first = first_above_noise(all, scale, 0.0, options);
        const bool found = first == 30U;
        const bool hidden = first && *first < 30;
        EXPECT_TRUE(hidden || found == above);
      }
      EXPECT_NEAR(static_cast<double>(passed) / static_cast<double>(tested), rate, 0.15 * rate);
    }
  }
}

TEST(Cfar, SeesAWallBesideAnotherOnlyWithTheSmallerNoise) {
  Bins bins(100, 10);
  for (std::size_t i = 40; i < 44; ++i) bins[i] = 90;
  for (std::size_t i = 60; i < 90; ++i) bins[i] = 200;
  const auto first_with = [&bins](CfarOptions::Noise noise) {
    EchoOptions options = options_of(Detector::kCfar, 20);
    options.cfar = {.noise = noise, .guard = 6, .training = 20};
    const auto echo = echo_in(bins, options);
    return echo ? echo->first : 0;
  };
  EXPECT_EQ(first_with(CfarOptions::Noise::kSmallestOf), 40U);
  EXPECT_NE(first_with(CfarOptions::Noise::kGreatestOf), 40U) << "the wall behind passes for noise";
  EXPECT_NE(first_with(CfarOptions::Noise::kCellAveraging), 40U) << "the wall behind passes for noise";
}

TEST(Detectors, KeepTheirPromisesOnAnySweepWithAnyOptions) {
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Sweep sweep{.extent = seed % 2 == 0 ? Sweep::Extent::kTurn : Sweep::Extent::kCut,
                .beams = std::vector<Beam>(random() % 40)};
    const std::uint64_t levels = 1 + random() % 256;
    for (Beam& beam : sweep.beams) {
      beam.bin_length_m = kBinLength_m;
      beam.intensities.resize(random() % 50);
      for (std::uint8_t& bin : beam.intensities) bin = static_cast<std::uint8_t>(random() % levels);
    }
    EchoOptions options = options_of(kDetectors[seed % kDetectors.size()]);
    if (random() % 2 == 0) options.threshold = static_cast<int>(1 + random() % 255);
    options.min_range_m = random() % 4 == 0 ? std::optional<double>{} : 0.1 * static_cast<double>(random() % 20);
    options.min_bin = random() % 30;
    options.max_range_m = 2.0 + 0.1 * static_cast<double>(random() % 40);
    options.canny.link = 1 + random() % 20;
    options.cfar.noise = static_cast<CfarOptions::Noise>(random() % 3);
    options.cfar.guard = random() % 20;
    options.cfar.training = 1 + random() % 30;
    if (random() % 2 == 0) options.cfar.scale = 1.0 + static_cast<double>(random() % 5);
    ASSERT_TRUE(options.validate());
    const auto echoes = echoes_of(sweep, options);
    ASSERT_EQ(echoes.size(), sweep.beams.size());
    for (std::size_t n = 0; n < echoes.size(); ++n) {
      if (!echoes[n]) continue;
      ++found;
      const Echo& echo = *echoes[n];
      ASSERT_LT(echo.last, sweep.beams[n].intensities.size());
      EXPECT_LE(echo.first, echo.peak);
      EXPECT_LE(echo.peak, echo.last);
      const std::size_t nearest = options.detector == Detector::kRise ? echo.peak : echo.first;
      EXPECT_GE(nearest, options.min_bin);
      EXPECT_GE(kBinLength_m * static_cast<double>(nearest), options.min_range_m.value_or(0.0) - 1e-9);
      EXPECT_GE(echo.range_m, options.min_range_m.value_or(0.0) - 1e-9);
      EXPECT_EQ(echo.intensity, sweep.beams[n].intensities[echo.peak]);
      EXPECT_GT(echo.range_m, kBinLength_m * static_cast<double>(echo.first));
      EXPECT_LT(echo.range_m, kBinLength_m * static_cast<double>(echo.last + 1));
      EXPECT_LE(echo.range_m, options.max_range_m);
    }
  }
  EXPECT_GT(found, 3000U);
}

// Kills a threshold by the gain of what is left when the wall is cut off: the clutter before it would become echoes.
TEST(Detectors, KnowTheGainFromWhatIsTooFarAway) {
  for (const Detector detector : {Detector::kRise, Detector::kLevel, Detector::kMax, Detector::kCfar}) {
    SCOPED_TRACE(static_cast<int>(detector));
    std::mt19937_64 random(1);
    Sweep sweep = even_turn_of(Bins());
    for (Beam& beam : sweep.beams) {
      beam.intensities = noisy_wall(random, 80, 60.0, 150.0);
      const auto faint = beam.intensities.begin() + 25 + static_cast<std::ptrdiff_t>(random() % 20);
      std::transform(faint, faint + 3, faint, [](std::uint8_t bin) { return static_cast<std::uint8_t>(bin + 60); });
    }
    EchoOptions options = options_of(detector);
    options.min_bin = 20;
    options.max_range_m = 5.0;
    std::size_t found = 0;
    for (const auto& echo : echoes_of(sweep, options)) found += echo ? 1 : 0;
    EXPECT_EQ(found, 0U);
    options.max_range_m = 7.0;
    for (const auto& echo : echoes_of(sweep, options)) {
      if (!echo) continue;
      ++found;
      EXPECT_LE(echo->range_m, 7.0);
    }
    EXPECT_GT(found, sweep.beams.size() / 2);
  }
}

// Kills a level by what is looked at alone: a wall that fills most of it would be its own background.
TEST(Detectors, KnowTheLevelFromWhatIsTooFarAway) {
  for (const Detector detector : {Detector::kLevel, Detector::kMax}) {
    SCOPED_TRACE(static_cast<int>(detector));
    Sweep sweep = even_turn_of(Bins());
    for (Beam& beam : sweep.beams) {
      beam.intensities.assign(80, 20);
      std::fill_n(beam.intensities.begin() + 22, 20, std::uint8_t{180});
    }
    EchoOptions options = options_of(detector);
    options.min_bin = 20;
    options.max_range_m = kBinLength_m * 40.0;
    std::size_t found = 0;
    for (const auto& echo : echoes_of(sweep, options)) found += echo ? 1 : 0;
    EXPECT_EQ(found, sweep.beams.size());
  }
}

TEST(Detectors, DoNotSeeWhatStandsBeforeTheRangeThatCounts) {
  std::size_t found = 0;
  for (const Detector detector : kDetectors) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(detector) << ", seed " << seed);
      std::mt19937_64 random(seed);
      Sweep sweep = even_turn_of(Bins());
      for (Beam& beam : sweep.beams) beam.intensities = noisy_wall(random, 80, 45.0, 150.0);
      EchoOptions options = options_of(detector);
      options.min_bin = 20;
      const auto before = echoes_of(sweep, options);
      for (Beam& beam : sweep.beams) {
        for (std::size_t i = 0; i < 20; ++i) beam.intensities[i] = static_cast<std::uint8_t>(random() % 256);
      }
      const auto after = echoes_of(sweep, options);
      for (std::size_t n = 0; n < before.size(); ++n) {
        ASSERT_EQ(before[n].has_value(), after[n].has_value());
        if (!before[n]) continue;
        ++found;
        EXPECT_EQ(before[n]->range_m, after[n]->range_m);
      }
    }
  }
  EXPECT_GT(found, 1800U);
}

TEST(ContrastsByGain, FollowsTheGainAndSeesNoEchoInNoise) {
  std::size_t walls = 0;
  std::size_t noises = 0;
  for (const Detector detector : kDetectors) {
    for (const double height : {35.0, 80.0, 230.0}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(detector) << ", " << height);
      std::mt19937_64 random(11);
      Sweep wall = even_turn_of(Bins());
      Sweep noise = wall;
      for (Beam& beam : wall.beams) beam.intensities = noisy_wall(random, 200, 120.0, height);
      for (Beam& beam : noise.beams) beam.intensities = noisy_wall(random, 200, 120.0, 0.0);
      const FilterOptions filter = default_filter(detector);
      for (const auto& echo : detect_echoes(apply_filter(PolarImage(wall), filter), wall, options_of(detector))) {
        ASSERT_TRUE(echo);
        EXPECT_NEAR(echo->range_m, 11.95, 0.2);  // the rise, not the crest one bin behind it
        ++walls;
      }
      for (const auto& echo : detect_echoes(apply_filter(PolarImage(noise), filter), noise, options_of(detector))) {
        EXPECT_FALSE(echo);
        ++noises;
      }
    }
  }
  EXPECT_EQ(walls, 600U);
  EXPECT_EQ(noises, 600U);
}

TEST(Contrasts, AreThePapersThresholdOnItsRecording) {
  std::vector<Beam> beams = test::TankRecording::beams(PINGVOX_SHARED_DATA);
  if (beams.empty()) GTEST_SKIP() << "no tank recording in " << PINGVOX_SHARED_DATA;
  beams.resize(200);
  const Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = std::move(beams)};
  const PolarImage image = apply_filter(PolarImage(sweep), {});
  const Contrasts contrasts(image, std::vector<BinWindow>(200, {60, 399}));
  std::vector<int> all;
  for (std::size_t n = 0; n < 200; ++n) all.push_back(contrasts.of(n));
  std::ranges::sort(all);
  EXPECT_NEAR(all[100], 70, 5);
}

}  // namespace
}  // namespace pingvox
