#include "pingvox/sonar/detect_echo.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <random>

#include "pingvox/sonar/filters.hpp"

namespace pingvox {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kWideBin_m = 0.1;
constexpr int kThreshold = 70;

std::optional<Echo> echo_of(std::vector<std::uint8_t> bins,
                            EchoOptions options = {.min_range_m = 0.0, .threshold = kThreshold},
                            double bin_length_m = kWideBin_m) {
  Sweep sweep{.extent = Sweep::Extent::kCut, .beams = std::vector<Beam>(1)};
  sweep.beams[0].bin_length_m = bin_length_m;
  sweep.beams[0].intensities = std::move(bins);
  const auto echoes = detect_echoes(PolarImage(sweep), sweep, options);
  EXPECT_EQ(echoes.size(), 1U);
  return echoes.at(0);
}

TEST(Rise, OfOneStepIsTheDifferenceOfTwoBins) {
  const auto echo = echo_of({10, 10, 80, 80, 10, 10});
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->first, 2U);
  EXPECT_EQ(echo->peak, 2U) << "the nearest of two equal ones";
  EXPECT_EQ(echo->last, 3U);
  EXPECT_EQ(echo->intensity, 80);
  EXPECT_DOUBLE_EQ(echo->range_m, 0.25) << "a bin before the middle of the crest, and not before the first bin";
  EXPECT_FALSE(echo_of({10, 10, 79, 79, 10, 10})) << "one less than the threshold";
}

// Kills a range taken from the image, where a window across beams has moved a slanting wall.
TEST(Rise, TakesTheRangeFromTheBeamsOwnBins) {
  Sweep sweep{.extent = Sweep::Extent::kCut, .beams = std::vector<Beam>(5)};
  for (std::size_t n = 0; n < 5; ++n) {
    sweep.beams[n].bin_length_m = 0.1;
    sweep.beams[n].intensities.assign(60, 0);
    const std::size_t wall = 20 + n * n;  // farther and farther
    for (std::size_t bin = wall; bin < wall + 5; ++bin) sweep.beams[n].intensities[bin] = 200;
  }
  EchoOptions options;
  options.threshold = 70;
  options.min_range_m = 0.0;
  const auto echoes = detect_echoes(apply_filter(PolarImage(sweep), {}), sweep, options);
  ASSERT_TRUE(echoes[3]);
  EXPECT_NEAR(echoes[3]->range_m, 0.1 * (29 + 2.5 - 1.0), 0.03);
}

TEST(Rise, AddsUpTheDifferencesOfASlope) {
  const auto echo = echo_of({0, 0, 20, 40, 60, 80, 100, 90, 80, 0, 0});
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->first, 5U);
  EXPECT_EQ(echo->peak, 6U);
  EXPECT_EQ(echo->last, 8U);
}

TEST(Rise, StaysTogetherAcrossADipOfHalfTheThresholdAndNoMore) {
  EXPECT_TRUE(echo_of({0, 50, 15, 70}));
  EXPECT_FALSE(echo_of({0, 50, 14, 70})) << "56 above the new valley";
  const auto echo = echo_of({0, 90, 55, 120, 84, 200});
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->peak, 3U) << "it ended before the 84";
  EXPECT_EQ(echo->last, 3U);
}

// Kills a search that goes on within the echo before, one that begins a bin too late, and echoes of one beam that are
// given to another.
TEST(AllEchoes, OfABeamAreThoseBehindTheEndOfTheOneBefore) {
  Sweep sweep{.extent = Sweep::Extent::kCut, .beams = std::vector<Beam>(3)};
  for (Beam& beam : sweep.beams) beam.bin_length_m = kWideBin_m;
  sweep.beams[0].intensities = {0, 90, 55, 120, 84, 200, 200, 0, 0, 0, 0, 70, 0};
  sweep.beams[1].intensities = std::vector<std::uint8_t>(13, 30);
  sweep.beams[2].intensities = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 100, 100};
  const EchoOptions options{.min_range_m = 0.0, .threshold = kThreshold};
  const PolarImage image(sweep);
  const auto all = detect_all_echoes(image, sweep, options);
  ASSERT_EQ(all.size(), 3U);
  ASSERT_EQ(all[0].size(), 3U);
  EXPECT_EQ(all[0][0].last, 3U);
  EXPECT_EQ(all[0][1].first, 5U) << "116 above bin 4, where nothing was before";
  EXPECT_EQ(all[0][1].last, 6U);
  EXPECT_EQ(all[0][2].first, 11U);
  EXPECT_TRUE(all[1].empty());
  ASSERT_EQ(all[2].size(), 1U);
  const auto first = detect_echoes(image, sweep, options);
  EXPECT_EQ(first[0]->range_m, all[0][0].range_m);
  EXPECT_FALSE(first[1]);
  EXPECT_EQ(first[2]->range_m, all[2][0].range_m);
}

// Kills a search that never ends because an echo is found again.
TEST(AllEchoes, EndWithEachDetector) {
  std::size_t found = 0;
  for (const Detector detector :
       {Detector::kRise, Detector::kLevel, Detector::kMax, Detector::kCanny, Detector::kCfar}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(testing::Message() << "detector " << static_cast<int>(detector) << ", seed " << seed);
      std::mt19937_64 random(seed);
      Sweep sweep{.extent = Sweep::Extent::kCut, .beams = std::vector<Beam>(5)};
      for (Beam& beam : sweep.beams) {
        beam.bin_length_m = kWideBin_m;
        for (int i = 0; i < 200; ++i) {
          beam.intensities.push_back(static_cast<std::uint8_t>(random() % 20 + (i % 50 < 6 && i > 6 ? 150 : 0)));
        }
      }
      const EchoOptions options{.detector = detector};
      const PolarImage image = apply_filter(PolarImage(sweep), {});
      const auto all = detect_all_echoes(image, sweep, options);
      const auto first = detect_echoes(image, sweep, options);
      for (std::size_t n = 0; n < all.size(); ++n) {
        ASSERT_EQ(all[n].empty(), !first[n]);
        for (std::size_t i = 1; i < all[n].size(); ++i) ASSERT_GT(all[n][i].first, all[n][i - 1].last);
        found += all[n].size();
      }
    }
  }
  EXPECT_GT(found, 500U);
}

TEST(Rise, StartsAtTheLowestBinOfItsValley) {
  EXPECT_TRUE(echo_of({60, 40, 20, 0, 40, 80}));
  EXPECT_FALSE(echo_of({60, 40, 30, 40, 80})) << "50 above the valley, although 80 is the strongest bin";
}

TEST(Rise, IsNotAFallingEdge) {
  EXPECT_FALSE(echo_of({255, 255, 0, 0, 0}));
  EXPECT_FALSE(echo_of({200, 150, 100, 50, 0}));
}

TEST(Rise, IsNotInAnEvenBeam) {
  EXPECT_FALSE(echo_of({}));
  EXPECT_FALSE(echo_of({255}));
  EXPECT_FALSE(echo_of(std::vector<std::uint8_t>(399, 0)));
  EXPECT_FALSE(echo_of(std::vector<std::uint8_t>(399, 255)));
}

TEST(Rise, MayBeInTheLastBinAndInTheWholeRangeOfIntensities) {
  const auto echo = echo_of({0, 0, 255}, {.min_range_m = 0.0, .threshold = 255});
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->last, 2U);
  EXPECT_EQ(echo->intensity, 255);
  EXPECT_TRUE(echo_of({254, 255}, {.min_range_m = 0.0, .threshold = 1}));
  EXPECT_FALSE(echo_of({255, 254}, {.min_range_m = 0.0, .threshold = 1}));
}

TEST(Blanking, NeverUsesANearerBinNotEvenAsTheFootOfARise) {
  // The step at bin 3 lies between a blanked bin and the first that counts.
  EXPECT_FALSE(echo_of({0, 0, 0, 200, 200, 200}, {.min_range_m = 0.3, .threshold = kThreshold}));
  const auto echo = echo_of({0, 200, 0, 0, 200, 0}, {.min_range_m = 0.3, .threshold = kThreshold});
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->first, 4U);
  EXPECT_FALSE(echo_of({0, 0, 200}, {.min_range_m = 0.15, .threshold = kThreshold}))
      << "bin 1 lies half inside the blanking range";
  EXPECT_FALSE(echo_of({0, 200}, {.min_range_m = 1e9, .threshold = kThreshold}));
}

TEST(Blanking, IsNotABinOffByRounding) {
  // 0.3 / 0.1 is less than 3, 0.7 / 0.1 less than 7, 0.6 / 0.2 less than 3.
  for (std::size_t n = 1; n < 200; ++n) {
    SCOPED_TRACE(n);
    for (const double bin_m : {0.1, 0.0125, 0.012531328015029430, 0.2, 1.0 / 3.0}) {
      SCOPED_TRACE(bin_m);
      std::vector<std::uint8_t> bins(n + 2, 0);
      bins[n + 1] = 200;
      const double range_m = static_cast<double>(n) * bin_m;
      EXPECT_TRUE(echo_of(bins, {.min_range_m = range_m, .threshold = kThreshold}, bin_m)) << "bin n counts";
      EXPECT_FALSE(echo_of(bins, {.min_range_m = range_m + 0.5 * bin_m, .threshold = kThreshold}, bin_m))
          << "bin n does not";
    }
  }
}

TEST(Blanking, GoesByEachBeamsOwnBinLength) {
  Sweep sweep{.extent = Sweep::Extent::kCut, .beams = std::vector<Beam>(2)};
  for (Beam& beam : sweep.beams) beam.intensities = {0, 0, 200, 0, 0, 0, 0, 200, 0, 0};
  sweep.beams[0].bin_length_m = 0.1;
  sweep.beams[1].bin_length_m = 0.5;
  const auto echoes = detect_echoes(PolarImage(sweep), sweep, {.min_range_m = 0.45, .threshold = kThreshold});
  ASSERT_TRUE(echoes[0] && echoes[1]);
  EXPECT_EQ(echoes[0]->peak, 7U);
  EXPECT_DOUBLE_EQ(echoes[0]->range_m, 0.75);
  EXPECT_EQ(echoes[1]->peak, 2U);
  EXPECT_DOUBLE_EQ(echoes[1]->range_m, 1.25);
}

TEST(MaxRange, CutsWhatLiesBeyondItOrAcrossIt) {
  const std::vector<std::uint8_t> bins{0, 0, 100, 200, 0};
  EXPECT_FALSE(echo_of(bins, {.min_range_m = 0.0, .max_range_m = 0.25, .threshold = kThreshold}));
  const auto echo = echo_of(bins, {.min_range_m = 0.0, .max_range_m = 0.3, .threshold = kThreshold});
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->intensity, 100) << "bin 3 lies beyond";
}

TEST(Detection, IgnoresWhatFillsUpAShortBeam) {
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = std::vector<Beam>(3)};
  sweep.beams[0].intensities = {0, 0, 0, 0, 100, 0};
  sweep.beams[1].intensities = {0, 0};
  for (Beam& beam : sweep.beams) beam.bin_length_m = kWideBin_m;
  PolarImage image(sweep);
  image.row(1)[4] = 255;
  image.row(2)[4] = 255;
  const auto echoes = detect_echoes(image, sweep, {.min_range_m = 0.0, .threshold = kThreshold});
  ASSERT_EQ(echoes.size(), 3U);
  EXPECT_TRUE(echoes[0]);
  EXPECT_FALSE(echoes[1]);
  EXPECT_FALSE(echoes[2]);
}

TEST(Detection, KeepsItsPromisesOnAnyBeam) {
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> bins(random() % 60);
    const std::uint64_t levels = 1 + random() % 256;
    for (std::uint8_t& bin : bins) bin = static_cast<std::uint8_t>(random() % levels);
    const EchoOptions options{.min_range_m = 0.1 * static_cast<double>(random() % 20),
                              .max_range_m = 2.0 + 0.1 * static_cast<double>(random() % 40),
                              .threshold = static_cast<int>(1 + random() % 255)};
    const auto echo = echo_of(bins, options);
    if (!echo) continue;
    ++found;
    EXPECT_LE(echo->first, echo->peak);
    EXPECT_LE(echo->peak, echo->last);
    ASSERT_LT(echo->last, bins.size());
    EXPECT_EQ(echo->intensity, bins[echo->peak]);
    EXPECT_GE(echo->intensity, *options.threshold);
    EXPECT_GE(kWideBin_m * static_cast<double>(echo->peak), *options.min_range_m - 1e-9);
    EXPECT_GE(echo->range_m, *options.min_range_m - 1e-9);
    EXPECT_GT(echo->range_m, kWideBin_m * static_cast<double>(echo->first));
    EXPECT_LT(echo->range_m, kWideBin_m * static_cast<double>(echo->last + 1));
    EXPECT_LE(echo->range_m, options.max_range_m);
  }
  EXPECT_GT(found, 900U);
}

TEST(EchoOptions, NameEveryBrokenField) {
  EXPECT_TRUE(EchoOptions{}.validate());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double range : {-0.1, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE((EchoOptions{.min_range_m = range}.validate())) << range;
  }
  for (const double range : {0.75, 0.1, nan}) EXPECT_FALSE((EchoOptions{.max_range_m = range}.validate())) << range;
  for (const int threshold : {0, -70, 256}) EXPECT_FALSE((EchoOptions{.threshold = threshold}.validate()));
  EXPECT_THAT((EchoOptions{.min_range_m = nan, .threshold = 0}.validate().error().message),
              AllOf(HasSubstr("min_range_m"), HasSubstr("max_range_m"), HasSubstr("threshold")));
}

}  // namespace
}  // namespace pingvox
