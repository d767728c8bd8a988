#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "pingvox/viewer/render_echoes.hpp"
#include "viewer/colours.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kLeftAxis = 110, kTitle = 44, kRowHeight = 16, kColumns = 400;

/// Where the marks below the picture begin, in pixels from range 0.
std::vector<int> range_marks(const Picture& picture, std::size_t beams) {
  const std::size_t below_frame = kTitle + beams * kRowHeight + 3;
  std::vector<int> marks;
  for (std::size_t x = kLeftAxis - 5; x < kLeftAxis + kColumns + 5; ++x) {
    if (picture.at(x, below_frame) == kInk && picture.at(x - 1, below_frame) != kInk) {
      marks.push_back(static_cast<int>(x) - static_cast<int>(kLeftAxis));
    }
  }
  return marks;
}

// Kills an axis without marks, and one of marks that are not as far apart as their ranges.
TEST(EchoAxes, OfAnyRangeHaveAFewMarksAtEvenSteps) {
  std::mt19937_64 random(17);
  for (int round = 0; round < 20; ++round) {
    const double bin_m = std::exp(std::uniform_real_distribution<double>(-6.0, -1.0)(random));
    SCOPED_TRACE(testing::Message() << "bins of " << bin_m << " m");
    const Beam beam{.time_s = 0.0,
                    .bearing_rad = 0.0,
                    .bin_length_m = bin_m,
                    .intensities = std::vector<std::uint8_t>(kColumns, 50)};
    const std::vector<Beam> beams(3, beam);
    const std::vector<int> marks = range_marks(render_echoes(beams, {}, {.target_px = kColumns}), beams.size());
    ASSERT_GE(marks.size(), 4U);
    ASSERT_LE(marks.size(), 8U);
    EXPECT_LE(std::abs(marks[0]), 1) << "at range 0";
    const int step = marks[1] - marks[0];
    for (std::size_t i = 2; i < marks.size(); ++i) EXPECT_NEAR(marks[i] - marks[i - 1], step, 1);
    EXPECT_LT(static_cast<int>(kColumns) - marks.back(), step + 2) << "up to the end";
  }
}

}  // namespace
}  // namespace pingvox
