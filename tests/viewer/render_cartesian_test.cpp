#include "pingvox/viewer/render_cartesian.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pingvox/geometry/degree.hpp"

using namespace pingvox;

namespace {

constexpr std::size_t kSize = 400, kLeft = 24 + 44, kTop = 24 + 44;
const Rgb kEcho = EchoPictureOptions{}.echo, kNothing = EchoPictureOptions{}.nothing;

Sweep sweep_between(double from_deg, double to_deg, double step_deg) {
  Sweep sweep{Sweep::Extent::kSector, {}};
  for (double bearing_deg = from_deg; bearing_deg < to_deg; bearing_deg += step_deg) {
    sweep.beams.push_back({.time_s = 0.0,
                           .bearing_rad = bearing_deg * kDegree_rad,
                           .bin_length_m = 0.1,
                           .intensities = std::vector<std::uint8_t>(100, 0)});
  }
  return sweep;
}

CartesianPictureOptions options_of(BetweenBeams between) {
  CartesianPictureOptions options;
  options.style.target_px = kSize;
  options.between = between;
  return options;
}

/// The colour where something at this range [m] of 10 m and this bearing lies.
Rgb colour_at(const Picture& picture, double range_m, double bearing_deg) {
  const double px = range_m / 10.0 * 0.5 * kSize, bearing_rad = bearing_deg * kDegree_rad;
  return picture.at(kLeft + static_cast<std::size_t>(0.5 * kSize - px * std::sin(bearing_rad)),
                    kTop + static_cast<std::size_t>(0.5 * kSize - px * std::cos(bearing_rad)));
}

TEST(RenderCartesian, PutsAheadUpAndLeftLeft) {
  Sweep sweep = sweep_between(0.0, 360.0, 1.0);
  for (Beam& beam : sweep.beams) {
    const bool is_left = beam.bearing_rad > 75.0 * kDegree_rad && beam.bearing_rad < 105.0 * kDegree_rad;
    if (is_left) beam.intensities[55] = 255;
  }
  std::vector<std::optional<Echo>> echoes(sweep.beams.size());
  echoes[20].emplace().range_m = 7.0;   // ahead, a little to the left
  echoes[300].emplace().range_m = 1e9;  // beyond everything
  const Picture picture = render_cartesian(sweep, PolarImage(sweep), echoes, options_of(BetweenBeams::kInterpolate));
  EXPECT_EQ(colour_at(picture, 5.55, 90.0), (Rgb{255, 255, 255}));
  EXPECT_EQ(colour_at(picture, 5.55, 270.0), (Rgb{0, 0, 0}));
  EXPECT_EQ(colour_at(picture, 7.0, 20.0), kEcho);
  EXPECT_EQ(colour_at(picture, 7.0, 340.0), (Rgb{0, 0, 0}));
  std::size_t marked = 0;
  for (std::size_t y = kTop; y < kTop + kSize; ++y) {
    for (std::size_t x = kLeft; x < kLeft + kSize; ++x) marked += picture.at(x, y) == kEcho ? 1 : 0;
  }
  EXPECT_LT(marked, 30U);
}

TEST(RenderCartesian, TellsSilenceFromWhereNobodyListened) {
  const Sweep sweep = sweep_between(30.0, 90.0, 2.0);
  for (const BetweenBeams between : {BetweenBeams::kInterpolate, BetweenBeams::kNothing}) {
    const Picture picture = render_cartesian(sweep, PolarImage(sweep), {}, options_of(between));
    EXPECT_EQ(colour_at(picture, 5.0, 60.0), (Rgb{0, 0, 0}));
    EXPECT_EQ(colour_at(picture, 5.0, 100.0), kNothing);
    EXPECT_EQ(colour_at(picture, 5.0, 20.0), kNothing);
    EXPECT_EQ(colour_at(picture, 5.0, 240.0), kNothing);
  }
}

TEST(RenderCartesian, DrawsWhateverIsValid) {
  std::size_t pictures = 0;
  for (Sweep sweep : {sweep_between(0.0, 0.0, 1.0), sweep_between(0.0, 1.0, 1.0), sweep_between(0.0, 720.0, 7.0)}) {
    for (const double bin_length_m : {5e-324, 1e-320, 0.1, 100.0}) {
      for (Beam& beam : sweep.beams) {
        beam.bin_length_m = bin_length_m;
        beam.bearing_rad = std::fmod(beam.bearing_rad, 2.0 * std::numbers::pi);
      }
      std::vector<std::optional<Echo>> echoes(sweep.beams.size(), Echo{});
      for (const BetweenBeams between : {BetweenBeams::kInterpolate, BetweenBeams::kNothing}) {
        CartesianPictureOptions options = options_of(between);
        options.style.target_px = 16;
        options.beam_width_rad = 2.0 * std::numbers::pi;
        EXPECT_LE(render_cartesian(sweep, PolarImage(sweep), echoes, options).width(), Picture::kMaxSide);
        ++pictures;
      }
    }
  }
  EXPECT_EQ(pictures, 24U);
}

TEST(CartesianPictureOptions, RefuseSenselessValues) {
  EXPECT_TRUE(CartesianPictureOptions{}.validate());
  CartesianPictureOptions bad;
  bad.style.target_px = 4;
  bad.beam_width_rad = 0.0;
  const auto refused = bad.validate();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("target_px"), std::string::npos);
  EXPECT_NE(refused.error().message.find("beam_width_rad"), std::string::npos);
}

}  // namespace
