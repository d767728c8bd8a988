#include "pingvox/viewer/render_echoes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "pingvox/geometry/degree.hpp"
#include "viewer/picture_text.hpp"

using namespace pingvox;

namespace {

constexpr std::size_t kLeftAxis = 110, kTitle = 44;

Beam beam_of(std::vector<std::uint8_t> intensities, double bin_length_m = 0.5) {
  return {.time_s = 0.0, .bearing_rad = 0.0, .bin_length_m = bin_length_m, .intensities = std::move(intensities)};
}

Echo echo_at(double range_m) {
  Echo echo;
  echo.range_m = range_m;
  return echo;
}

const std::vector<std::pair<Rgb, char>> kLetters = {{Rgb{0, 0, 0}, '.'},
                                                    {Rgb{128, 128, 128}, 'o'},
                                                    {Rgb{255, 255, 255}, '#'},
                                                    {EchoPictureOptions{}.echo, '|'},
                                                    {EchoPictureOptions{}.nothing, ' '}};

TEST(RenderEchoes, RowsAreBeamsAndColumnsAreRange) {
  // The third beam has fewer bins, the fourth twice as long ones.
  const std::vector<Beam> beams = {beam_of({0, 0, 255, 0}), beam_of({255, 0, 0, 0}), beam_of({64, 255}),
                                   beam_of({0, 255}, 1.0)};
  const Picture picture = render_echoes(beams, {}, {.target_px = 16});
  EXPECT_EQ(as_text(picture, kLeftAxis, kTitle, 16, 1, 1, kLetters), "........####....\n");
  std::string rows;
  for (std::size_t row = 0; row < 4; ++row) rows += as_text(picture, kLeftAxis, kTitle + row * 16, 4, 1, 4, kLetters);
  EXPECT_EQ(rows,
            "..#.\n"
            "#...\n"
            "o#  \n"
            "..##\n");
}

TEST(RenderEchoes, MarksEachEchoWhereItIs) {
  const std::vector<Beam> beams = {beam_of({0, 0, 0, 0}), beam_of({0, 0, 0, 0}), beam_of({0, 0, 0, 0})};
  const std::vector<std::optional<Echo>> echoes = {echo_at(1.0), std::nullopt, echo_at(1.75)};
  const Picture picture = render_echoes(beams, echoes, {.target_px = 16});
  std::string rows;
  for (std::size_t row = 0; row < 3; ++row) rows += as_text(picture, kLeftAxis, kTitle + row * 16, 16, 1, 1, kLetters);
  EXPECT_EQ(rows,
            ".......|||......\n"
            "................\n"
            ".............|||\n");
}

TEST(RenderEchoes, ManyBeamsShareRowsAndNoEchoIsLost) {
  std::vector<Beam> beams;
  std::vector<std::optional<Echo>> echoes;
  for (int n = 0; n < 5604; ++n) {
    beams.push_back(beam_of(std::vector<std::uint8_t>(399, 0), 0.0125));
    beams.back().intensities[100] = n % 3 == 1 ? 255 : 0;
    echoes.push_back(n == 4000 ? std::optional(echo_at(2.5)) : std::nullopt);
  }
  const Picture picture = render_echoes(beams, echoes);
  EXPECT_LE(picture.height(), 2200U);
  EXPECT_LE(picture.width(), 1200U);
  constexpr std::size_t kRows = 1868;  // of three beams each
  std::size_t bright = 0, marked = 0;
  for (std::size_t y = kTitle; y < kTitle + kRows; ++y) {
    for (std::size_t x = kLeftAxis; x < kLeftAxis + 798; ++x) {
      bright += picture.at(x, y) == Rgb{255, 255, 255} ? 1 : 0;
      marked += picture.at(x, y) == EchoPictureOptions{}.echo ? 1 : 0;
    }
  }
  EXPECT_EQ(bright, kRows * 2);
  EXPECT_EQ(marked, 3U);
}

/// Rows with a tick at the right of the image.
std::vector<std::size_t> bearing_ticks(const Picture& picture, std::size_t columns, std::size_t row_px) {
  std::vector<std::size_t> rows;
  const std::size_t x = kLeftAxis + columns + 2 + 4;
  for (std::size_t y = kTitle; y < picture.height() - 96; ++y) {
    const bool is_first = picture.at(x, y) != Rgb{255, 255, 255} && picture.at(x, y - 1) == Rgb{255, 255, 255};
    if (is_first) rows.push_back((y - kTitle) / row_px);
  }
  return rows;
}

TEST(RenderEchoes, MarksRoundBearingsWhereTheHeadPassesThem) {
  // A turn and a half in steps of 1.8 degrees, clockwise from 45 degrees: 45, 0 (360), 315 ... every 45.
  std::vector<Beam> beams;
  for (int n = 0; n < 300; ++n) {
    beams.push_back(beam_of({0, 0, 0, 0}));
    const double turned_rad = (45.0 - 1.8 * n) * kDegree_rad;
    beams.back().bearing_rad = turned_rad - 2.0 * std::numbers::pi * std::floor(turned_rad / (2.0 * std::numbers::pi));
  }
  const Picture turning = render_echoes(beams, {}, {.target_px = 16});
  EXPECT_EQ(bearing_ticks(turning, 16, 2),
            (std::vector<std::size_t>{0, 25, 50, 75, 100, 125, 150, 175, 200, 225, 250, 275}));
  // A head that stands still on no round bearing passes none.
  for (Beam& beam : beams) beam.bearing_rad = 1.234;
  EXPECT_TRUE(bearing_ticks(render_echoes(beams, {}, {.target_px = 16}), 16, 2).empty());
}

TEST(RenderEchoes, DrawsWhateverIsValid) {
  std::size_t pictures = 0;
  const auto draws = [&](const std::vector<Beam>& beams) {
    const Picture picture = render_echoes(beams, std::vector<std::optional<Echo>>(beams.size(), echo_at(1e9)));
    EXPECT_LE(picture.width(), Picture::kMaxSide);
    EXPECT_LE(picture.height(), Picture::kMaxSide);
    ++pictures;
  };
  draws({});
  draws({beam_of({})});
  draws({beam_of({1})});
  draws({beam_of({1, 2, 3}, 5e-324), beam_of({1}, 1e-323)});
  draws({beam_of({1, 2, 3}, 5e-324), beam_of({1, 2}, 5000.0)});
  draws({beam_of(std::vector<std::uint8_t>(100'000, 7), 0.001), beam_of({9, 9})});
  draws(std::vector<Beam>(20'000, beam_of({1, 2, 3})));
  EXPECT_EQ(pictures, 7U);
}

TEST(EchoPictureOptions, RefuseSenselessValues) {
  EXPECT_TRUE(EchoPictureOptions{}.validate());
  EXPECT_FALSE(EchoPictureOptions{.target_px = 3}.validate());
  EXPECT_FALSE(EchoPictureOptions{.gamma = 0.0}.validate());
}

}  // namespace
