#include "bench/draw/chart.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace pingvox::bench {
namespace {

std::set<std::uint32_t> colours_of(const Picture& picture) {
  std::set<std::uint32_t> colours;
  for (std::size_t i = 0; i < picture.rgb().size(); i += 3) {
    const auto rgb = picture.rgb().subspan(i, 3);
    colours.insert(static_cast<std::uint32_t>(rgb[0] << 16 | rgb[1] << 8 | rgb[2]));
  }
  return colours;
}

/// Pixels of the series' colours, whatever else is drawn.
std::size_t count_of(const Picture& picture, Rgb colour) {
  std::size_t count = 0;
  for (std::size_t y = 0; y < picture.height(); ++y) {
    for (std::size_t x = 0; x < picture.width(); ++x) count += picture.at(x, y) == colour ? 1 : 0;
  }
  return count;
}

double luminance(Rgb colour) {
  const auto linear = [](std::uint8_t value) { return std::pow(value / 255.0, 2.2); };
  return 0.2126 * linear(colour.red) + 0.7152 * linear(colour.green) + 0.0722 * linear(colour.blue);
}

constexpr Rgb kFirst{16, 24, 72};
constexpr std::array kColours = {kFirst,           Rgb{222, 100, 0}, Rgb{110, 50, 130}, Rgb{235, 184, 60},
                                 Rgb{0, 116, 128}, Rgb{90, 172, 220}};

TEST(Chart, LinesRiseFromTheLowerLeft) {
  const Chart chart{.series = {{"only", {1.0, 3.0}, {0.0, 10.0}}}};
  const Picture picture = render_chart(chart);
  // Without its legend: the mark of the first point is in the lower left, that of the second in the upper right.
  const auto marked = [&](std::size_t left, std::size_t right, std::size_t top, std::size_t bottom) {
    std::size_t count = 0;
    for (std::size_t y = top; y < bottom; ++y) {
      for (std::size_t x = left; x < right; ++x) count += picture.at(x, y) == kFirst ? 1 : 0;
    }
    return count;
  };
  EXPECT_GT(marked(60, 140, 540, 600), 100U);
  EXPECT_GT(marked(920, 980, 54, 120), 100U);
  EXPECT_EQ(marked(100, 300, 60, 300), 0U);
  EXPECT_EQ(marked(800, 940, 400, 600), 0U);
}

TEST(Chart, BarsAreAsHighAsTheirNumbers) {
  const Chart chart{.kind = Chart::Kind::kBars, .categories = {"a", "b"}, .series = {{"x", {10.0, 5.0}}}};
  const Picture picture = render_chart(chart);
  // Each column of pixels is in one of the bars, or in none.
  std::set<std::size_t> heights;
  for (std::size_t x = 100; x < 940; ++x) {
    std::size_t height = 0;
    for (std::size_t y = 70; y < 570; ++y) height += picture.at(x, y) == kFirst ? 1 : 0;
    if (height > 50) heights.insert(height);
  }
  ASSERT_EQ(heights.size(), 2U);
  EXPECT_NEAR(static_cast<double>(*heights.rbegin()) / static_cast<double>(*heights.begin()), 2.0, 0.02);
}

// Kills names that run into each other.
TEST(Chart, NamesThatWouldTouchStandInTwoRows) {
  const auto rows_of_names = [](const std::string& name) {
    const Chart chart{.kind = Chart::Kind::kBars,
                      .categories = std::vector<std::string>(8, name),
                      .series = {{"x", std::vector<double>(8, 1.0)}}};
    const Picture picture = render_chart(chart);
    std::size_t rows = 0;
    bool before = false;
    for (std::size_t y = picture.height() - 60; y < picture.height(); ++y) {
      std::size_t ink = 0;
      for (std::size_t x = 0; x < picture.width(); ++x) ink += luminance(picture.at(x, y)) < 0.2 ? 1 : 0;
      rows += ink > 0 && !before ? 1 : 0;
      before = ink > 0;
    }
    return rows;
  };
  EXPECT_EQ(rows_of_names("XX"), 1U);
  EXPECT_EQ(rows_of_names("XXXXXXXXXXXX"), 2U);
}

TEST(Chart, LeavesOutWhatItsAxesCannotShow) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  Chart chart{.x_spacing = Spacing::kLogarithmic,
              .y_spacing = Spacing::kLogarithmic,
              .series = {{"odd", {1.0, nan, -3.0, 0.0, inf, 100.0}, {1.0, 2.0, 3.0, 0.0, 5.0, 1000.0}}}};
  ASSERT_TRUE(chart.validate());
  const Picture with_odd = render_chart(chart);
  // The two numbers left are not joined, since what is between them is missing.
  chart.series = {{"odd", {1.0, nan, 100.0}, {1.0, 2.0, 1000.0}}};
  const Picture without = render_chart(chart);
  EXPECT_TRUE(std::equal(with_odd.rgb().begin(), with_odd.rgb().end(), without.rgb().begin()));
  std::size_t pictures = 0;
  for (const std::vector<double>& y : {std::vector<double>{}, {nan}, {1e-310, 1e308}, {-1e308, 1e308}, {7.0, 7.0}}) {
    for (const Spacing spacing : {Spacing::kLinear, Spacing::kLogarithmic}) {
      for (const Chart::Kind kind : {Chart::Kind::kLines, Chart::Kind::kBars}) {
        const Chart any{.kind = kind,
                        .y_spacing = spacing,
                        .categories = std::vector<std::string>(y.size(), "c"),
                        .series = {{"s", y, std::vector<double>(y.size(), 1.0)}},
                        .y_mark = 1.0};
        ASSERT_TRUE(any.validate());
        EXPECT_EQ(render_chart(any).width(), 1000U);
        ++pictures;
      }
    }
  }
  EXPECT_EQ(pictures, 20U);
}

TEST(Chart, SeriesDifferInLightness) {
  Chart chart{.kind = Chart::Kind::kBars, .categories = {"one"}};
  std::vector<double> seen;
  for (const Rgb colour : kColours) {
    chart.series.push_back({"s", {1.0}});
    EXPECT_GT(count_of(render_chart(chart), colour), 500U);
    for (const double other : seen) EXPECT_GT(std::abs(std::log(luminance(colour) / other)), std::log(1.25));
    seen.push_back(luminance(colour));
  }
  EXPECT_GT(colours_of(render_chart(chart)).size(), 6U);
}

TEST(Chart, RefusesWhatDoesNotFitTogether) {
  EXPECT_FALSE(Chart{}.validate());
  EXPECT_FALSE((Chart{.series = {{"a", {1.0}, {}}}}).validate());
  EXPECT_FALSE((Chart{.kind = Chart::Kind::kBars, .categories = {}, .series = {{"a", {1.0}}}}).validate());
  EXPECT_FALSE((Chart{.series = std::vector<Series>(7, Series{"a", {1.0}, {1.0}})}).validate());
  EXPECT_FALSE((Chart{.series = {{"a", {1.0}, {1.0}}}, .width = 5000}).validate());
}

}  // namespace
}  // namespace pingvox::bench
