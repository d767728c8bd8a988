#include "pingvox/sonar/cartesian_image.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace pingvox {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

/// A turn whose intensity is a function of bearing and bin.
template <class Intensity>
Sweep turn_of(std::size_t beams, std::size_t bins, Intensity intensity) {
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = std::vector<Beam>(beams)};
  for (std::size_t n = 0; n < beams; ++n) {
    // Clockwise, as heads turn: bearings fall, and jump once.
    const double bearing = wrap_bearing(-2.0 * kPi * static_cast<double>(n) / static_cast<double>(beams));
    sweep.beams[n] = {.time_s = 0.0, .bearing_rad = bearing, .bin_length_m = 0.1, .intensities = {}};
    for (std::size_t i = 0; i < bins; ++i) sweep.beams[n].intensities.push_back(intensity(bearing, i));
  }
  return sweep;
}

TEST(CartesianImage, OfRingsHasTheBinOfItsRangeInEachPixel) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const std::size_t bins = 5 + random() % 40;
    std::vector<std::uint8_t> rings(bins);
    for (std::uint8_t& ring : rings) ring = static_cast<std::uint8_t>(random() % 256);
    const Sweep sweep = turn_of(200, bins, [&rings](double, std::size_t i) { return rings[i]; });
    const CartesianImage image = cartesian_image(PolarImage(sweep), sweep, {.size_px = 64 + random() % 64});
    EXPECT_NEAR(image.pixel_m * static_cast<double>(image.size_px), 0.2 * static_cast<double>(bins), 1e-9);
    for (std::size_t row = 0; row < image.size_px; ++row) {
      for (std::size_t column = 0; column < image.size_px; ++column) {
        const double bin = std::hypot(image.x_m(row), image.y_m(column)) / 0.1;
        if (std::abs(bin - std::round(bin)) < 1e-6) continue;  // on the border of two rings
        const auto i = static_cast<std::size_t>(bin);
        ASSERT_EQ(image.at(row, column), i < bins ? rings[i] : 0) << row << ", " << column;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 100'000U);
}

// Fast heads step by more than the width of a beam.
TEST(CartesianImage, HasNoGapsBetweenTheBeamsOfACoarseTurn) {
  for (const std::size_t beams : {36U, 100U, 120U, 200U}) {
    const Sweep sweep = turn_of(beams, 40, [](double, std::size_t) { return std::uint8_t{90}; });
    const CartesianImage image = cartesian_image(PolarImage(sweep), sweep, {.size_px = 200});
    for (std::size_t row = 0; row < image.size_px; ++row) {
      for (std::size_t column = 0; column < image.size_px; ++column) {
        if (std::hypot(image.x_m(row), image.y_m(column)) > 3.99) continue;
        ASSERT_EQ(image.at(row, column), 90) << beams << " beams: " << row << ", " << column;
      }
    }
  }
}

TEST(CartesianImage, LeavesASectorWithoutBeamsEmpty) {
  Sweep sweep = turn_of(100, 40, [](double, std::size_t) { return std::uint8_t{90}; });
  std::erase_if(sweep.beams, [](const Beam& beam) { return std::abs(beam.bearing_rad - kPi) < kPi / 4.0; });
  const CartesianImage image = cartesian_image(PolarImage(sweep), sweep, {.size_px = 200});
  EXPECT_EQ(image.at(150, 100), 0) << "astern";
  EXPECT_EQ(image.at(50, 100), 90) << "ahead";
}

TEST(CartesianImage, GoesEvenlyFromOneAxisToTheNextAlsoAcrossBearingZero) {
  // Intensity falls along a cosine; between axes 1.8 degrees apart a straight line is as good.
  const Sweep sweep = turn_of(200, 40, [](double bearing, std::size_t) {
    return static_cast<std::uint8_t>(std::lround(120.0 + 100.0 * std::cos(bearing)));
  });
  // Twice the step: each place is reached by two beams, with weights that add up to 1.
  const CartesianImage image =
      cartesian_image(PolarImage(sweep), sweep, {.size_px = 200, .beam_width_rad = 4.0 * kPi / 200.0});
  std::size_t checked = 0;
  for (std::size_t row = 0; row < image.size_px; ++row) {
    for (std::size_t column = 0; column < image.size_px; ++column) {
      const double x = image.x_m(row);
      const double y = image.y_m(column);
      if (std::hypot(x, y) >= 3.99) continue;
      ASSERT_NEAR(image.at(row, column), 120.0 + 100.0 * std::cos(std::atan2(y, x)), 1.2) << row << ", " << column;
      ++checked;
    }
  }
  EXPECT_GT(checked, 30'000U);
}

TEST(CartesianImage, ShowsAheadUpAndLeftLeft) {
  for (const BetweenBeams between : {BetweenBeams::kNothing, BetweenBeams::kInterpolate}) {
    const auto place_of = [between](double degrees) {
      const Sweep sweep = turn_of(200, 40, [degrees](double bearing, std::size_t i) {
        const double off = std::remainder(bearing - degrees * kPi / 180.0, 2.0 * kPi);
        return static_cast<std::uint8_t>(std::abs(off) < 0.01 && i == 30 ? 200 : 0);
      });
      const CartesianImage image = cartesian_image(PolarImage(sweep), sweep, {.between = between, .size_px = 100});
      const auto brightest = std::ranges::max_element(image.pixels) - image.pixels.begin();
      // No pixel's middle need be on the axis, and between axes it is mixed with the next beam's.
      EXPECT_GE(image.pixels[static_cast<std::size_t>(brightest)], between == BetweenBeams::kNothing ? 200 : 100);
      return std::pair(image.x_m(static_cast<std::size_t>(brightest) / 100),
                       image.y_m(static_cast<std::size_t>(brightest) % 100));
    };
    EXPECT_NEAR(place_of(0.0).first, 3.05, 0.1);
    EXPECT_NEAR(place_of(90.0).second, 3.05, 0.1);
    EXPECT_NEAR(place_of(180.0).first, -3.05, 0.1);
    EXPECT_NEAR(place_of(270.0).second, -3.05, 0.1);
  }
}

// Kills a border between the last bearing and the first one.
TEST(CartesianImage, OfATurnedSweepIsTheTurnedImage) {
  std::mt19937_64 random(3);
  std::vector<std::uint8_t> loudness(36);
  for (std::uint8_t& value : loudness) value = static_cast<std::uint8_t>(random());
  Sweep sweep{.extent = Sweep::Extent::kTurn, .beams = {}};
  for (std::size_t n = 0; n < loudness.size(); ++n) {
    sweep.beams.push_back({.bearing_rad = static_cast<double>(n) * kPi / 18.0 + 0.01,
                           .bin_length_m = 0.1,
                           .intensities = std::vector<std::uint8_t>(40, loudness[n])});
  }
  const CartesianOptions options{.size_px = 100, .beam_width_rad = 0.5};
  const CartesianImage image = cartesian_image(PolarImage(sweep), sweep, options);
  for (Beam& beam : sweep.beams) beam.bearing_rad = wrap_bearing(beam.bearing_rad + kPi / 2.0);
  const CartesianImage turned = cartesian_image(PolarImage(sweep), sweep, options);
  for (std::size_t row = 0; row < 100; ++row) {
    for (std::size_t column = 0; column < 100; ++column) {
      ASSERT_NEAR(turned.at(99 - column, row), image.at(row, column), 1) << row << ", " << column;
    }
  }
}

TEST(CartesianImage, KnowsNothingBetweenBeamsThatAreFartherApartThanTheyReach) {
  const Sweep sweep = turn_of(8, 40, [](double, std::size_t) { return std::uint8_t{100}; });
  const CartesianImage image = cartesian_image(PolarImage(sweep), sweep, {.size_px = 200, .beam_width_rad = 0.1});
  std::size_t known = 0;
  for (std::size_t row = 0; row < image.size_px; ++row) {
    for (std::size_t column = 0; column < image.size_px; ++column) {
      const double x = image.x_m(row);
      const double y = image.y_m(column);
      const double off = std::abs(std::remainder(std::atan2(y, x), kPi / 4.0));
      if (std::abs(off - 0.05) < 1e-9) continue;
      const bool reached = off < 0.05 && std::hypot(x, y) < 4.0;
      ASSERT_EQ(image.at(row, column), reached ? 100 : 0) << row << ", " << column;
      known += reached ? 1U : 0U;
    }
  }
  EXPECT_GT(known, 500U);
}

TEST(CartesianImage, RawIsTheLoudestBinOfEachPixelAndNothingElse) {
  const Sweep sweep =
      turn_of(16, 40, [](double, std::size_t i) { return static_cast<std::uint8_t>(i < 8 ? 0 : i + 1); });
  const CartesianImage image =
      cartesian_image(PolarImage(sweep), sweep, {.between = BetweenBeams::kNothing, .size_px = 400});
  // Bins are 5 pixels long, and from bin 8 on the 16 beams lie as far apart: a dot each.
  EXPECT_EQ(std::ranges::count_if(image.pixels, [](std::uint8_t pixel) { return pixel > 0; }), 16 * 32);
  const CartesianImage coarse =
      cartesian_image(PolarImage(sweep), sweep, {.between = BetweenBeams::kNothing, .size_px = 16});
  EXPECT_EQ(std::ranges::max(coarse.pixels), 40);
}

TEST(CartesianImage, OfNothingIsBlack) {
  for (const std::size_t beams : {0U, 3U}) {
    Sweep sweep{.extent = Sweep::Extent::kCut, .beams = std::vector<Beam>(beams)};
    for (Beam& beam : sweep.beams) beam.bin_length_m = 0.1;
    EXPECT_THAT(cartesian_image(PolarImage(sweep), sweep, {.size_px = 16}).pixels, Each(0));
  }
}

TEST(CartesianOptions, NameEveryBrokenField) {
  EXPECT_TRUE(CartesianOptions{}.validate());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double width : {0.0, -1.0, 7.0, nan}) {
    EXPECT_THAT((CartesianOptions{.size_px = 0, .beam_width_rad = width}.validate().error().message),
                AllOf(HasSubstr("size_px"), HasSubstr("beam_width_rad")));
  }
}

}  // namespace
}  // namespace pingvox
