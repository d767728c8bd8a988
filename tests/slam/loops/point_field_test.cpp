#include "slam/loops/point_field.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pingvox/geometry/degree.hpp"
#include "tests/support/uniform.hpp"

namespace pingvox::test {
namespace {

constexpr double kCell_m = 0.2;

std::vector<Eigen::Vector2d> points_of_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  std::vector<Eigen::Vector2d> points;
  const int count = static_cast<int>((b - a).norm() / kCell_m);
  for (int i = 0; i < count; ++i) points.emplace_back(a + (b - a) * i / count);
  return points;
}

std::vector<Eigen::Vector2d> join(std::vector<Eigen::Vector2d> points, const std::vector<Eigen::Vector2d>& more) {
  points.insert(points.end(), more.begin(), more.end());
  return points;
}

/// Points as seen from `pose` in the field.
std::vector<Eigen::Vector2d> seen_from(const std::vector<Eigen::Vector2d>& points, const Pose2& pose) {
  std::vector<Eigen::Vector2d> seen;
  for (const Eigen::Vector2d& point : points) seen.push_back(pose.inverse() * point);
  return seen;
}

TEST(PointField, FindsAnyPoseWithinTheWindow) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < 60; ++i) points.emplace_back(uniform(random, -10, 10), uniform(random, -10, 10));
    const Pose2 truth{{uniform(random, -4, 4), uniform(random, -4, 4)}, uniform(random, -20, 20) * kDegree_rad};
    const PointField field(points, kCell_m, 40);
    // The middle of the points is what is searched around.
    const auto match = field.match(seen_from(points, truth), {}, {40, 24 * kDegree_rad}, 0.5);
    ASSERT_TRUE(match);
    EXPECT_LT((match->pose.place_m - truth.place_m).norm(), 0.5 * kCell_m);
    EXPECT_NEAR(match->pose.yaw_rad, truth.yaw_rad, 0.5 * kDegree_rad);
    EXPECT_GT(match->score, 0.9);
  }
}

// Kills a bound that is too low: branches with the best pose would be left out.
TEST(PointField, NoPoseOfTheWindowHasAHigherScore) {
  std::mt19937_64 random(3);
  std::vector<Eigen::Vector2d> points, others;
  for (int i = 0; i < 40; ++i) points.emplace_back(uniform(random, -6, 6), uniform(random, -6, 6));
  for (int i = 0; i < 20; ++i) others.push_back(points[static_cast<std::size_t>(i)]);
  for (int i = 0; i < 20; ++i) others.emplace_back(uniform(random, -6, 6), uniform(random, -6, 6));
  const PointField field(points, kCell_m, 12);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : others) middle += point / 40.0;
  const auto match = field.match(others, {}, {12, 4 * kDegree_rad}, 0.1);
  ASSERT_TRUE(match);
  double highest = 0.0;
  for (int yaw = -4; yaw <= 4; ++yaw) {
    for (int x = -24; x <= 24; ++x) {
      for (int y = -24; y <= 24; ++y) {
        const double yaw_rad = yaw * kDegree_rad;
        const Eigen::Vector2d place = middle + 0.5 * kCell_m * Eigen::Vector2d(x, y) - rotation2(yaw_rad) * middle;
        highest = std::max(highest, field.score(others, {place, yaw_rad}));
      }
    }
  }
  EXPECT_GT(match->score, highest - 0.02);
}

TEST(PointField, FindsNothingInOtherPoints) {
  const PointField field(points_of_line({-8, 0}, {8, 0}), kCell_m, 20);
  const auto cross = join(points_of_line({0, -8}, {0, 8}), points_of_line({3, -8}, {3, 8}));
  EXPECT_FALSE(field.match(cross, {}, {20, 10 * kDegree_rad}, 0.5));
}

// Along a straight canal any place is as good as the next one.
TEST(PointField, FindsNothingBetweenTwoParallelWalls) {
  const auto canal = join(points_of_line({-20, -3}, {20, -3}), points_of_line({-20, 3}, {20, 3}));
  const auto part = join(points_of_line({-5, -3}, {5, -3}), points_of_line({-5, 3}, {5, 3}));
  const PointField field(canal, kCell_m, 40);
  EXPECT_FALSE(field.match(part, {}, {40, 10 * kDegree_rad}, 0.3));
}

TEST(PointField, IsLessSureAlongALongWall) {
  const auto corner = join(points_of_line({0, 0}, {12, 0}), points_of_line({0, 0}, {0, 2}));
  const auto match = PointField(corner, kCell_m, 10).match(corner, {}, {10, 4 * kDegree_rad}, 0.5);
  ASSERT_TRUE(match);
  EXPECT_GT(match->covariance(0, 0), 1.5 * match->covariance(1, 1));
}

TEST(PointField, AMirrorImageIsNoMatch) {
  const auto hook =
      join(join(points_of_line({0, 0}, {10, 0}), points_of_line({10, 0}, {10, 4})), points_of_line({3, 0}, {3, 6}));
  std::vector<Eigen::Vector2d> mirrored;
  for (const Eigen::Vector2d& point : hook) mirrored.emplace_back(-point.x(), point.y());
  const PointField field(hook, kCell_m, 60);
  const auto match = field.match(mirrored, {}, {60, 180 * kDegree_rad}, 0.0);
  EXPECT_TRUE(!match || match->score < 0.8);
  EXPECT_GT(field.match(hook, {}, {60, 20 * kDegree_rad}, 0.0)->score, 0.9);
}

}  // namespace
}  // namespace pingvox::test
