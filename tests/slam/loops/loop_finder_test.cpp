// Places that are seen again, and places that only look as if they were: mirrored, turned about, repeated, along a
// straight canal.

#include "pingvox/slam/loop_finder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "tests/slam/walls.hpp"
#include "tests/support/uniform.hpp"

namespace pingvox::test {
namespace {

constexpr double kReach_m = 30.0;
/// Windows as for a scanning sonar with a compass.
constexpr LoopOptions kOptions{kReach_m, 12.0, 10.0 * kDegree_rad, 0.8};

using Walls = std::vector<Wall>;
const Walls kBasin = {{0, 0, 60, -4},   {60, -4, 64, 30}, {64, 30, 40, 34}, {40, 34, 38, 50},
                      {38, 50, -4, 46}, {-4, 46, 0, 0},   {20, -1, 21, 12}, {21, 12, 24, 12},
                      {24, 12, 24, -1}, {-2, 28, 14, 29}, {14, 29, 14, 33}, {14, 33, -2, 33}};
const Walls kOtherBasin = {{-6, -9, 30, 3},  {30, 3, 47, -12}, {47, -12, 70, 9}, {70, 9, 58, 27},
                           {58, 27, 71, 48}, {71, 48, 25, 52}, {25, 52, 16, 41}, {16, 41, -5, 55},
                           {-5, 55, 3, 17},  {3, 17, -6, -9},  {33, 20, 45, 24}, {45, 24, 33, 26}};

/// Places every 1.5 m along a line of corners, ahead.
std::vector<Pose2> places_along(std::span<const Eigen::Vector2d> corners) {
  std::vector<Pose2> places;
  for (std::size_t c = 0; c + 1 < corners.size(); ++c) {
    const Eigen::Vector2d way = corners[c + 1] - corners[c];
    for (double along_m = 0.0; along_m < way.norm(); along_m += 1.5) {
      places.push_back({corners[c] + along_m * way.normalized(), std::atan2(way.y(), way.x())});
    }
  }
  return places;
}
const std::vector<Eigen::Vector2d> kLap = {{8, 8}, {14, 20}, {34, 18}, {52, 10}, {54, 24}, {30, 26}, {10, 20}, {8, 8}};

/// A recording of what a sonar saw that turned once at each place.
struct Recorded {
  std::vector<KeyFrame> frames;
  std::vector<Pose2> truth;
  std::mt19937_64 random{1};

  /// @param drift  by which the odometry is off from now on
  void go(std::span<const Pose2> places, const Walls& walls, const Pose2& drift) {
    for (const Pose2& place : places) {
      KeyFrame frame{drift * place, {}};
      for (double bearing_rad = -3.0; bearing_rad < 3.2; bearing_rad += 0.06) {
        const double range_m = range_to_walls_m(walls, place.place_m, place.yaw_rad + bearing_rad);
        if (range_m > kReach_m) continue;
        const double heard_m = range_m + uniform(random, -0.15, 0.15);
        frame.points_m.push_back(heard_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad)));
      }
      truth.push_back(place);
      frames.push_back(std::move(frame));
    }
  }
  /// Goes out of sight of all walls and comes back, so that no submap is of before and after.
  void leave() {
    const std::vector<Eigen::Vector2d> away = {{8, 8}, {-8, 8}, {8, 8}};
    go(places_along(away), {}, {});
  }
  Loops find(const LoopOptions& options = kOptions) const {
    std::vector<Pose2> poses;
    for (const KeyFrame& frame : frames) poses.push_back(frame.odometry);
    return find_loops(frames, poses, options);
  }
  /// How far a loop is from the truth.
  double error_m(const PoseEdge& loop) const {
    return residual_of(loop, truth[loop.a], truth[loop.b]).head<2>().norm();
  }
};

/// How many loops join the key frames before `end` with those from `begin` on.
std::size_t joining(const Loops& loops, std::size_t end, std::size_t begin) {
  return static_cast<std::size_t>(
      std::ranges::count_if(loops.kept, [&](const PoseEdge& loop) { return loop.b < end && loop.a >= begin; }));
}

TEST(LoopFinder, OptionsNameEveryBrokenField) {
  EXPECT_TRUE(LoopOptions{}.validate());
  const auto valid = LoopOptions{30.0, 301.0, 4.0, 0.0}.validate();
  ASSERT_FALSE(valid);
  for (const char* field : {"window_m", "window_yaw_rad", "points_within"}) {
    EXPECT_NE(valid.error().message.find(field), std::string::npos) << field;
  }
  EXPECT_FALSE((LoopOptions{.reach_m = 0.0, .window_m = 0.0}.validate()));
}

TEST(LoopFinder, FindsAPlaceThatIsSeenAgainWhereItIs) {
  Recorded drive;
  drive.go(places_along(kLap), kBasin, {});
  drive.go(places_along(kLap), kBasin, {{7.0, -5.0}, 0.06});
  const Loops loops = drive.find();
  EXPECT_GT(loops.kept.size(), 10U);
  for (const PoseEdge& loop : loops.kept) EXPECT_LT(drive.error_m(loop), 0.6) << loop.a << " " << loop.b;
}

// Kills a search that begins elsewhere, and submaps of sweeps that did not follow each other.
TEST(LoopFinder, LooksFromTheNewestAndKeepsPassesApart) {
  Recorded drive;
  drive.go(places_along(kLap), kBasin, {});
  const std::size_t first = drive.frames.size();
  drive.leave();
  const std::size_t second = drive.frames.size();
  drive.go(places_along(kLap), kBasin, {{3.0, -2.0}, 0.05});
  LoopOptions newest = kOptions;
  newest.first = drive.frames.size() - 16;
  const Loops loops = drive.find(newest);
  ASSERT_GT(joining(loops, first, second), 3U);
  for (const PoseEdge& loop : loops.kept) EXPECT_GE(loop.a, newest.first);
  // Each frame for itself has too few points.
  for (std::size_t k = 0; k < drive.frames.size(); ++k) drive.frames[k].pass = k;
  EXPECT_LT(drive.find(newest).found, loops.found);
}

TEST(LoopFinder, DoesNotTakeAnyPlaceForAnother) {
  Recorded drive;
  drive.go(places_along(kLap), kBasin, {});
  const std::size_t end = drive.frames.size();
  drive.leave();
  const std::size_t begin = drive.frames.size();
  drive.go(places_along(kLap), kOtherBasin, {});
  EXPECT_EQ(joining(drive.find(), end, begin), 0U);
}

TEST(LoopFinder, DoesNotTakeAPlaceForItsMirrorImage) {
  Recorded drive;
  drive.go(places_along(kLap), kOtherBasin, {});
  const std::size_t end = drive.frames.size();
  drive.leave();
  const std::size_t begin = drive.frames.size();
  Walls mirrored;
  std::vector<Eigen::Vector2d> lap;
  for (const auto& [ax, ay, bx, by] : kOtherBasin) mirrored.push_back({60 - ax, ay, 60 - bx, by});
  for (const Eigen::Vector2d& corner : kLap) lap.emplace_back(60 - corner.x(), corner.y());
  drive.go(places_along(lap), mirrored, {});
  EXPECT_EQ(joining(drive.find(), end, begin), 0U);
}

// Going back, the bay to starboard in the west looks like the one to starboard in the east did on the way there.
TEST(LoopFinder, TellsACanalFromTheSameTurnedAbout) {
  const Walls canal = {{-40, 6, 4, 6},    {4, 6, 4, 14},     {4, 14, 12, 14},    {12, 14, 12, 6},   {12, 6, 80, 6},
                       {-40, -6, 28, -6}, {28, -6, 28, -14}, {28, -14, 36, -14}, {36, -14, 36, -6}, {36, -6, 80, -6}};
  Recorded drive;
  const std::vector<Eigen::Vector2d> there = {{-10, 0}, {50, 0}}, back = {{50, 0}, {-10, 0}};
  drive.go(places_along(there), canal, {});
  drive.go(places_along(back), canal, {{4.0, 2.0}, 0.03});
  const Loops loops = drive.find();
  EXPECT_GT(loops.kept.size(), 0U);
  for (const PoseEdge& loop : loops.kept) EXPECT_LT(drive.error_m(loop), 1.0) << loop.a << " " << loop.b;
}

TEST(LoopFinder, DoesNotTakeABayForTheNextOne) {
  Walls bays = {{-60, -8, 200, -8}};
  for (double x = -45.0; x < 180.0; x += 15.0) {
    bays.insert(bays.end(), {{x, 8, x + 2, 14}, {x + 2, 14, x + 8, 14}, {x + 8, 14, x + 9, 8}, {x + 9, 8, x + 15, 8}});
  }
  Recorded drive;
  const std::vector<Eigen::Vector2d> there = {{0, 0}, {100, 0}}, back = {{100, 0}, {0, 0}};
  drive.go(places_along(there), bays, {});
  drive.go(places_along(back), bays, {{9.0, 0.0}, 0.0});
  for (const PoseEdge& loop : drive.find().kept) EXPECT_LT(drive.error_m(loop), 1.0) << loop.a << " " << loop.b;
}

// A sonar that sees a bit of both banks at its sides: where it was going along a straight canal cannot be told, though
// the ends of what it saw fit best in one place.
TEST(LoopFinder, IsNotPulledAlongAStraightCanal) {
  Recorded drive;
  for (const double off_m : {0.0, 5.0}) {
    for (double x = 0.0; x < 60.0; x += 1.2) {
      KeyFrame frame{{{x, 0.0}, 0.0}, {}};
      for (double ahead = -1.5; ahead < 1.5; ahead += 0.2) {
        for (const double side : {-6.0, 6.0}) {
          frame.points_m.emplace_back(ahead + uniform(drive.random, -0.1, 0.1),
                                      side + uniform(drive.random, -0.1, 0.1));
        }
      }
      drive.frames.push_back(std::move(frame));
      drive.truth.push_back({{x + off_m, 0.0}, 0.0});
    }
  }
  LoopOptions options = kOptions;
  options.points_within = 3.0;
  const Loops loops = drive.find(options);
  EXPECT_GT(loops.kept.size(), 0U);
  // Less than what a pull by a reach would cost: ten standard deviations.
  for (const PoseEdge& loop : loops.kept) {
    EXPECT_LT(loop.information(0, 0) * kReach_m * kReach_m, 10.0) << loop.a << " " << loop.b;
    EXPECT_GT(loop.information(1, 1), 1.0);
  }
}

}  // namespace
}  // namespace pingvox::test
