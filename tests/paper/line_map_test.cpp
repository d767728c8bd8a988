// Section 3.2 of the paper: a map of features.
#include "bench/paper/line_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pingvox/geometry/pose2.hpp"
#include "pingvox/geometry/random.hpp"

namespace pingvox::bench {
namespace {

using Eigen::Vector2d;
using Sweep = std::vector<Vector2d>;

LineMap lines_of(const std::vector<Sweep>& sweeps) {
  return extract_lines(sweeps, {});
}

/// Echoes of a head in the middle of a square room of 6 m, 200 beams a turn, with a deviation along the beam.
Sweep square_room(double deviation_m, std::uint64_t seed) {
  Random random(seed);
  Sweep echoes;
  for (int n = 0; n < 200; ++n) {
    const double bearing_rad = 2.0 * std::numbers::pi * n / 200.0;
    const Vector2d ahead(std::cos(bearing_rad), std::sin(bearing_rad));
    echoes.emplace_back((3.0 / ahead.cwiseAbs().maxCoeff() + deviation_m * random.normal()) * ahead);
  }
  return echoes;
}

Sweep moved(const Pose2& pose, Sweep echoes) {
  for (Vector2d& echo : echoes) echo = pose * echo;
  return echoes;
}

/// Points on a wall from one place to another, `count` of them.
Sweep wall(const Vector2d& from, const Vector2d& to, int count) {
  Sweep echoes;
  for (int n = 0; n < count; ++n) echoes.emplace_back(from + n / (count - 1.0) * (to - from));
  return echoes;
}

Sweep arc(double radius_m, double from_rad, double to_rad, int count) {
  Sweep echoes;
  for (int n = 0; n < count; ++n) {
    const double angle = from_rad + n * (to_rad - from_rad) / (count - 1);
    echoes.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle));
  }
  return echoes;
}

TEST(LineMap, ASquareRoomHasFourWallsAndFourCornersHoweverItIsTurned) {
  for (const Pose2& pose : {Pose2{}, Pose2{{20.0, -7.0}, std::numbers::pi / 6.0}}) {
    std::vector<Sweep> sweeps;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) sweeps.push_back(moved(pose, square_room(0.02, seed)));
    const LineMap map = lines_of(sweeps);
    ASSERT_EQ(map.lines.size(), 4U);
    ASSERT_EQ(map.corners.size(), 4U);
    std::size_t echoes = 0;
    for (const WallLine& line : map.lines) {
      EXPECT_NEAR((line.to_m - line.from_m).norm(), 6.0, 0.05);
      EXPECT_NEAR(line.deviation_m, 0.018, 0.006) << "less than along the beam, by the cosine of the angle";
      echoes += line.echoes;
    }
    EXPECT_NEAR(static_cast<double>(echoes), 600.0, 24.0) << "those in a corner may count for both walls";
    for (const Corner& corner : map.corners) {
      const Vector2d there = pose.inverse() * corner.place_m;
      EXPECT_NEAR(std::abs(there.x()), 3.0, 0.02);
      EXPECT_NEAR(std::abs(there.y()), 3.0, 0.02);
      for (const std::uint32_t line : {corner.line, corner.other_line}) {
        const WallLine& meets = map.lines[line];
        EXPECT_TRUE(meets.from_m == corner.place_m || meets.to_m == corner.place_m);
      }
    }
  }
}

TEST(LineMap, PartsOfAWallSeenByDifferentSweepsAreFittedAsIfSeenAtOnce) {
  Random random(7);
  Sweep first, second;
  for (int n = 0; n < 60; ++n) {
    // A little bent in the middle, so that the two fits are apart.
    first.emplace_back(0.05 * n, 0.02 * random.normal());
    second.emplace_back(2.0 + 0.05 * n, 0.03 * n / 60.0 + 0.02 * random.normal());
  }
  Sweep all = first;
  all.insert(all.end(), second.begin(), second.end());
  std::ranges::sort(all, {}, [](const Vector2d& point) { return point.x(); });
  const LineMap parts = lines_of({first, second}), whole = lines_of({all});
  ASSERT_EQ(parts.lines.size(), 1U);
  ASSERT_EQ(whole.lines.size(), 1U);
  EXPECT_EQ(parts.lines[0].echoes, 120U);
  EXPECT_NEAR(parts.lines[0].deviation_m, whole.lines[0].deviation_m, 1e-9);
  const auto slope = [](const WallLine& line) {
    const Vector2d along = line.to_m - line.from_m;
    return along.y() / along.x();
  };
  EXPECT_NEAR(slope(parts.lines[0]), slope(whole.lines[0]), 1e-9);
  EXPECT_NEAR((parts.lines[0].to_m - parts.lines[0].from_m).norm(), 4.95, 0.01);
}

TEST(LineMap, WallsWithAGapOrSideBySideStayTwo) {
  const auto lines_with = [](const Sweep& there) {
    Sweep sweep = wall({0.0, 0.0}, {3.0, 0.0}, 30);
    sweep.insert(sweep.end(), there.begin(), there.end());
    return lines_of({sweep}).lines.size();
  };
  EXPECT_EQ(lines_with(wall({3.8, 0.0}, {7.0, 0.0}, 30)), 1U);
  EXPECT_EQ(lines_with(wall({4.2, 0.0}, {7.0, 0.0}, 30)), 2U);
  EXPECT_EQ(lines_with(wall({0.0, 0.5}, {3.0, 0.5}, 30)), 2U);
}

TEST(LineMap, WallsThatNearlyGoOnMakeNoCorner) {
  const auto corners = [](double angle_rad) {
    const Vector2d end(3.0 * std::cos(angle_rad), 3.0 * std::sin(angle_rad));
    const Sweep sweep[] = {wall({-3.0, 0.0}, {-0.2, 0.0}, 30), wall(0.1 * end, end, 30)};
    return lines_of({sweep[0], sweep[1], sweep[0], sweep[1]}).corners.size();
  };
  EXPECT_EQ(corners(0.4), 0U);
  EXPECT_EQ(corners(0.6), 1U);
}

TEST(LineMap, StrayEchoesNeitherMakeALineNorBendOne) {
  Random random(3);
  std::vector<Sweep> strays(20);
  for (Sweep& sweep : strays) {
    for (int n = 0; n < 200; ++n) sweep.emplace_back(10.0 * random.uniform(), 10.0 * random.uniform());
  }
  EXPECT_TRUE(lines_of(strays).lines.empty());

  std::vector<Sweep> sweeps;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Sweep sweep = square_room(0.01, seed);
    for (std::size_t n = 0; n < sweep.size(); n += 11) sweep[n] *= 0.2 + 0.6 * random.uniform();
    sweeps.push_back(sweep);
  }
  const LineMap map = lines_of(sweeps);
  EXPECT_EQ(map.lines.size(), 4U);
  for (const WallLine& line : map.lines) EXPECT_LT(line.deviation_m, 0.015);
}

TEST(LineMap, WhatOneSweepAloneSawIsLeftOut) {
  const Sweep quay = wall({0.0, 0.0}, {3.0, 0.0}, 30), passing_boat = wall({0.0, 2.0}, {3.0, 2.0}, 30);
  Sweep both = quay;
  both.insert(both.end(), passing_boat.begin(), passing_boat.end());
  EXPECT_EQ(lines_of({both}).lines.size(), 2U);
  EXPECT_EQ(lines_of({quay, both, quay}).lines.size(), 1U);
  EXPECT_EQ(lines_of({both, quay, both}).lines.size(), 2U);
}

TEST(LineMap, OfRoundThingsALargeOneHasShortLinesAndAPileNone) {
  EXPECT_TRUE(lines_of({arc(0.25, 0.0, 3.0, 20)}).lines.empty());
  std::vector<Sweep> sweeps;
  for (int n = 0; n < 10; ++n) sweeps.push_back(arc(3.0, 0.05 * n, 2.0 + 0.05 * n, 40));
  const LineMap hull = lines_of(sweeps);
  EXPECT_FALSE(hull.lines.empty());
  for (const WallLine& line : hull.lines) {
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      EXPECT_NEAR((line.from_m + share * (line.to_m - line.from_m)).norm(), 3.0, 0.25);
    }
  }
}

TEST(LineMap, TooLittleMakesNothing) {
  EXPECT_TRUE(lines_of({}).lines.empty());
  EXPECT_TRUE(lines_of({Sweep{}, Sweep{{1.0, 2.0}}}).lines.empty());
  EXPECT_TRUE(lines_of({Sweep(30, Vector2d(1.0, 2.0))}).lines.empty()) << "all in one place";
  EXPECT_TRUE(lines_of({wall({0.0, 0.0}, {3.0, 0.0}, 5)}).lines.empty()) << "five echoes";
  EXPECT_EQ(lines_of({wall({0.0, 0.0}, {3.0, 0.0}, 6)}).lines.size(), 1U);
}

}  // namespace
}  // namespace pingvox::bench
