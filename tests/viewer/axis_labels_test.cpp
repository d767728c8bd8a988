#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "viewer/axis.hpp"
#include "viewer/colours.hpp"

namespace pingvox {
namespace {

// Kills an axis of small or large numbers without ticks, and labels that do not say where they stand.
TEST(AxisLabels, SayTheValueAtTheirPlace) {
  std::mt19937_64 random(29);
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int round = 0; round < 500; ++round) {
    const double start = std::pow(10.0, between(-9.0, 9.0)) * (round % 2 == 0 ? 1.0 : -1.0);
    const double span = std::abs(start) * std::pow(10.0, between(-6.0, 3.0));
    const AxisScale scale{.at_start = start, .at_end = round % 3 == 0 ? start - span : start + span};
    SCOPED_TRACE(testing::Message() << "round " << round << " of seed 29: " << scale.at_start << " to "
                                    << scale.at_end);
    const std::size_t most = 6 + random() % 8;
    const std::vector<Tick> ticks = ticks_of(scale, most);
    ASSERT_FALSE(ticks.empty());
    ASSERT_LE(ticks.size(), most + 2);
    std::set<std::string> texts;
    for (const Tick& tick : ticks) {
      texts.insert(tick.text);
      EXPECT_GE(tick.share, -1e-6);
      EXPECT_LE(tick.share, 1.0 + 1e-6);
      const double value = scale.at_start + tick.share * (scale.at_end - scale.at_start);
      EXPECT_NEAR(std::stod(tick.text), value, 0.01 * span / static_cast<double>(most));
    }
    EXPECT_EQ(texts.size(), ticks.size()) << "each another text";
  }
}

// Kills a second row of labels that goes up into the picture.
TEST(AxisLabels, LieOutsideOfTheArea) {
  constexpr Area kArea{160, 40, 300, 200};
  Picture picture(500, 340, kPaper);
  const std::vector<Tick> ticks = ticks_of({1000000.1, 1000001.1}, 8);
  draw_bottom_axis(picture, kArea, ticks, "easting in m");
  draw_left_axis(picture, kArea, ticks, "northing in m");
  std::size_t below = 0, left = 0;
  for (std::size_t y = 0; y < picture.height(); ++y) {
    for (std::size_t x = 0; x < picture.width(); ++x) {
      if (picture.at(x, y) == kPaper) continue;
      below += y >= 240 ? 1U : 0U;
      left += x < 160 ? 1U : 0U;
      const bool is_within = x > 160 && x < 460 && y > 40 && y < 240;
      ASSERT_FALSE(is_within) << x << ", " << y;
    }
  }
  EXPECT_GT(below, 500U);
  EXPECT_GT(left, 500U);
}

}  // namespace
}  // namespace pingvox
