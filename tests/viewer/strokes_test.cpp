#include "viewer/strokes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace pingvox {
namespace {

constexpr Rgb kWhite{255, 255, 255}, kBlack{0, 0, 0};
constexpr std::size_t kSide = 61;
constexpr Area kAll{0, 0, kSide, kSide};
/// The middle of the middle pixel.
constexpr Spot kMiddle{30.5, 30.5};

Picture paper() {
  return {kSide, kSide, kWhite};
}

int ink_at(const Picture& picture, std::size_t x, std::size_t y) {
  return 255 - picture.at(x, y).red;
}

/// How many pixels are covered, those at an edge by their share.
double ink_of(const Picture& picture) {
  double sum = 0.0;
  for (std::size_t y = 0; y < kSide; ++y) {
    for (std::size_t x = 0; x < kSide; ++x) sum += ink_at(picture, x, y) / 255.0;
  }
  return sum;
}

// Kills a shape that is cut off at one side, and one that is wider or thicker than was asked for.
TEST(Strokes, CoverTheAreaOfTheirShape) {
  std::mt19937_64 random(3);
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int round = 0; round < 50; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round << " of seed 3");
    const Spot middle{between(28.0, 33.0), between(28.0, 33.0)};
    const double radius = between(8.0, 20.0), width = between(2.0, 6.0);
    const double edge = 0.02 * 2.0 * std::numbers::pi * radius;  // antialiasing rounds

    Picture disc = paper();
    draw_disc(disc, middle, radius, kBlack);
    EXPECT_NEAR(ink_of(disc), std::numbers::pi * radius * radius, edge);

    Picture circle = paper();
    draw_circle(circle, middle, radius, width, kBlack, 0.5, kAll);
    EXPECT_NEAR(ink_of(circle), 0.5 * 2.0 * std::numbers::pi * radius * width, edge);

    Picture line = paper();
    const Spot end{between(10.0, 50.0), between(10.0, 50.0)};
    draw_line(line, middle, end, width, kBlack, kAll);
    const double length = std::hypot(end.x - middle.x, end.y - middle.y);
    EXPECT_NEAR(ink_of(line), length * width + 0.25 * std::numbers::pi * width * width, 0.02 * (length + width) + 0.5);
  }
}

// Kills a triangle with a side that is nearer to its middle than the others.
TEST(Strokes, MarkersAreBalancedAroundTheirMiddle) {
  for (const Marker marker :
       {Marker::kDisc, Marker::kSquare, Marker::kTriangle, Marker::kDiamond, Marker::kCross, Marker::kPlus}) {
    SCOPED_TRACE(static_cast<int>(marker));
    Picture picture = paper();
    draw_marker(picture, marker, kMiddle, 12.0, kBlack);
    double across = 0.0, down = 0.0;
    for (std::size_t y = 0; y < kSide; ++y) {
      for (std::size_t x = 0; x < kSide; ++x) {
        across += ink_at(picture, x, y) / 255.0 * (static_cast<double>(x) + 0.5);
        down += ink_at(picture, x, y) / 255.0 * (static_cast<double>(y) + 0.5);
      }
    }
    EXPECT_NEAR(across / ink_of(picture), kMiddle.x, 0.1);
    EXPECT_NEAR(down / ink_of(picture), kMiddle.y, 0.1);
  }
}

TEST(Strokes, AreTheSameFromEitherSide) {
  for (const Marker marker : {Marker::kDisc, Marker::kSquare, Marker::kTriangle, Marker::kDiamond, Marker::kRing,
                              Marker::kCross, Marker::kPlus}) {
    SCOPED_TRACE(static_cast<int>(marker));
    constexpr double kRadius = 12.0;
    Picture picture = paper();
    draw_marker(picture, marker, kMiddle, kRadius, kBlack);
    std::size_t first = kSide, last = 0;
    for (std::size_t y = 0; y < kSide; ++y) {
      for (std::size_t x = 0; x < kSide; ++x) {
        const int ink = ink_at(picture, x, y);
        ASSERT_NEAR(ink, ink_at(picture, kSide - 1 - x, y), 1) << x << ", " << y;
        if (marker != Marker::kTriangle) {
          ASSERT_NEAR(ink, ink_at(picture, x, kSide - 1 - y), 1) << x << ", " << y;
          ASSERT_NEAR(ink, ink_at(picture, y, x), 1) << x << ", " << y;
        }
        if (ink <= 128) continue;
        first = std::min(first, x);
        last = std::max(last, x);
      }
    }
    ASSERT_LE(first, last);
    EXPECT_NEAR(static_cast<double>(last + 1 - first), 2.0 * kRadius, 0.65 * kRadius) << "about so wide";
  }
}

TEST(Strokes, StayWithinTheirArea) {
  constexpr Area kPart{20, 25, 15, 10};
  Picture picture = paper(), whole = paper();
  for (Picture* of : {&picture, &whole}) {
    const Area& area = of == &whole ? kAll : kPart;
    draw_line(*of, {0.0, 5.0}, {60.0, 55.0}, 5.0, kBlack, area);
    draw_circle(*of, kMiddle, 8.0, 4.0, kBlack, 1.0, area);
  }
  for (std::size_t y = 0; y < kSide; ++y) {
    for (std::size_t x = 0; x < kSide; ++x) {
      const bool is_within = x >= 20 && x < 35 && y >= 25 && y < 35;
      ASSERT_EQ(ink_at(picture, x, y), is_within ? ink_at(whole, x, y) : 0) << x << ", " << y;
    }
  }
}

TEST(Strokes, AFrameLiesAroundItsArea) {
  Picture picture = paper();
  draw_frame(picture, {20, 25, 15, 10}, 3, kBlack);
  for (std::size_t y = 0; y < kSide; ++y) {
    for (std::size_t x = 0; x < kSide; ++x) {
      const bool is_within = x >= 20 && x < 35 && y >= 25 && y < 35;
      const bool is_near = x >= 17 && x < 38 && y >= 22 && y < 38;
      ASSERT_EQ(ink_at(picture, x, y), is_near && !is_within ? 255 : 0) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace pingvox
