#include "pingvox/slam/pose_graph.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/support/uniform.hpp"

namespace pingvox::test {
namespace {

/// Poses around a circle that ends where it began.
std::vector<Pose2> circle() {
  std::vector<Pose2> poses;
  constexpr int kCount = 40;
  for (int i = 0; i <= kCount; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCount;
    poses.push_back({{10.0 * std::sin(angle), 10.0 - 10.0 * std::cos(angle)}, wrap_angle(angle)});
  }
  return poses;
}

const Eigen::Matrix3d kInformation = Eigen::Vector3d(100.0, 100.0, 2500.0).asDiagonal();

PoseEdge edge_between(const std::vector<Pose2>& poses, std::size_t a, std::size_t b) {
  return {a, b, poses[a].inverse() * poses[b], kInformation};
}

struct Drifted {
  std::vector<PoseEdge> odometry;
  std::vector<Pose2> poses;
};

/// Steps that are too long and turn too far.
Drifted drift(const std::vector<Pose2>& truth) {
  Drifted result{{}, {truth.front()}};
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    PoseEdge edge = edge_between(truth, i, i + 1);
    edge.a_from_b = edge.a_from_b * Pose2{{0.05, 0.02}, 0.01};
    result.odometry.push_back(edge);
    result.poses.push_back(result.poses.back() * edge.a_from_b);
  }
  return result;
}

double largest_error_m(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    largest = std::max(largest, (poses[i].place_m - truth[i].place_m).norm());
  }
  return largest;
}

double cost(const std::vector<Pose2>& poses, const std::vector<PoseEdge>& edges) {
  double sum = 0.0;
  for (const PoseEdge& edge : edges) {
    const Eigen::Vector3d residual = residual_of(edge, poses[edge.a], poses[edge.b]);
    sum += residual.dot(edge.information * residual);
  }
  return sum;
}

TEST(PoseGraph, ALoopSpreadsTheDrift) {
  const std::vector<Pose2> truth = circle();
  Drifted drifted = drift(truth);
  const double before_m = largest_error_m(drifted.poses, truth);
  const auto weights = solve_pose_graph(drifted.poses, drifted.odometry, std::vector{edge_between(truth, 0, 40)});
  EXPECT_LT(largest_error_m(drifted.poses, truth), 0.3 * before_m);
  EXPECT_GT(weights.at(0), 0.5);
}

// Kills wrong derivatives: an edge that is weak throughout makes the cost nearly that of the loops' squares.
TEST(PoseGraph, NoNearbyPosesHaveLessCost) {
  const std::vector<Pose2> truth = circle();
  Drifted drifted = drift(truth);
  PoseEdge first = edge_between(truth, 3, 30), second = edge_between(truth, 10, 35);
  first.information *= 1e-4;
  second.information *= 1e-4;
  solve_pose_graph(drifted.poses, drifted.odometry, std::vector{first, second});
  std::vector<PoseEdge> all = drifted.odometry;
  all.insert(all.end(), {first, second});
  const double least = cost(drifted.poses, all);
  std::mt19937_64 random(5);
  for (int i = 0; i < 100; ++i) {
    std::vector<Pose2> moved = drifted.poses;
    for (std::size_t k = 1; k < moved.size(); ++k) {
      moved[k].place_m += Eigen::Vector2d(uniform(random, -1e-3, 1e-3), uniform(random, -1e-3, 1e-3));
      moved[k].yaw_rad += uniform(random, -1e-3, 1e-3);
    }
    EXPECT_GT(cost(moved, all), least);
  }
}

TEST(PoseGraph, AWrongLoopAmongRightOnesHardlyCounts) {
  const std::vector<Pose2> truth = circle();
  Drifted drifted = drift(truth);
  std::vector<PoseEdge> loops = {edge_between(truth, 0, 40), edge_between(truth, 1, 39), edge_between(truth, 2, 38)};
  PoseEdge wrong = edge_between(truth, 5, 25);
  wrong.a_from_b.place_m += Eigen::Vector2d(15.0, 0.0);
  loops.push_back(wrong);
  const auto weights = solve_pose_graph(drifted.poses, drifted.odometry, loops);
  EXPECT_LT(weights.at(3), 0.05);
  EXPECT_LT(largest_error_m(drifted.poses, truth), 1.0);
}

TEST(PoseGraph, TheFirstPoseStaysAndWithoutLoopsAllDo) {
  const std::vector<Pose2> truth = circle();
  Drifted drifted = drift(truth);
  const std::vector<Pose2> before = drifted.poses;
  EXPECT_TRUE(solve_pose_graph(drifted.poses, drifted.odometry, {}).empty());
  EXPECT_LT(largest_error_m(drifted.poses, before), 1e-9);
}

}  // namespace
}  // namespace pingvox::test
