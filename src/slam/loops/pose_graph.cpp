#include "pingvox/slam/pose_graph.hpp"

#include <cassert>
#include <cstdint>
#include <utility>

#include "slam/least_squares/normal_equations.hpp"
#include "slam/loops/pose_edges.hpp"

namespace pingvox {
namespace {

constexpr int kIterations = 30;
/// Squared distance, in standard deviations, at which a loop counts half.
constexpr double kCauchy2 = 4.0;

/// Derivatives of the residual of an edge.
struct ByPoses {
  Eigen::Matrix3d a = -Eigen::Matrix3d::Identity(), b = Eigen::Matrix3d::Identity();
};
ByPoses derivatives(const Pose2& a, const Pose2& b) {
  const Eigen::Matrix2d turn = rotation2(-a.yaw_rad);
  const Eigen::Vector2d between = turn * (b.place_m - a.place_m);
  ByPoses by;
  by.a.topLeftCorner<2, 2>() = -turn;
  by.a.topRightCorner<2, 1>() = Eigen::Vector2d(between.y(), -between.x());
  by.b.topLeftCorner<2, 2>() = turn;
  return by;
}

}  // namespace

Eigen::Vector3d residual_of(const PoseEdge& edge, const Pose2& a, const Pose2& b) {
  Eigen::Vector3d residual;
  residual.head<2>() = rotation2(-a.yaw_rad) * (b.place_m - a.place_m) - edge.a_from_b.place_m;
  residual[2] = wrap_angle(b.yaw_rad - a.yaw_rad - edge.a_from_b.yaw_rad);
  return residual;
}

double loop_weight(const PoseEdge& edge, const Pose2& a, const Pose2& b) {
  const Eigen::Vector3d residual = residual_of(edge, a, b);
  return 1.0 / (1.0 + residual.dot(edge.information * residual) / kCauchy2);
}

void add_edge(const PoseEdge& edge, const Pose2& a, const Pose2& b, double weight, NormalEquations& equations) {
  const ByPoses by = derivatives(a, b);
  const Eigen::Matrix3d of_b = weight * by.b.transpose() * edge.information;
  add_edge_to_fixed(edge, a, b, weight, equations);
  equations.add_block(edge.b, edge.b, of_b * by.b);
  equations.add_block(edge.b, edge.a, of_b * by.a);
  equations.gradient.segment<3>(static_cast<Eigen::Index>(3 * edge.b)) += of_b * residual_of(edge, a, b);
}

void add_edge_to_fixed(const PoseEdge& edge, const Pose2& a, const Pose2& b, double weight,
                       NormalEquations& equations) {
  const Eigen::Matrix3d by_a = derivatives(a, b).a, of_a = weight * by_a.transpose() * edge.information;
  equations.add_block(edge.a, edge.a, of_a * by_a);
  equations.gradient.segment<3>(static_cast<Eigen::Index>(3 * edge.a)) += of_a * residual_of(edge, a, b);
}

std::vector<double> solve_pose_graph(std::vector<Pose2>& poses, std::span<const PoseEdge> odometry,
                                     std::span<const PoseEdge> loops) {
  assert(!poses.empty());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& edges : {odometry, loops}) {
    for (const PoseEdge& edge : edges) {
      pairs.emplace_back(static_cast<std::uint32_t>(edge.a), static_cast<std::uint32_t>(edge.b));
    }
  }
  const auto weights = [&] {
    std::vector<double> each;
    for (const PoseEdge& loop : loops) each.push_back(loop_weight(loop, poses[loop.a], poses[loop.b]));
    return each;
  };
  for (int i = 0; i < kIterations; ++i) {
    NormalEquations equations(poses.size(), 0, pairs);
    equations.add_block(0, 0, 1e12 * Eigen::Matrix3d::Identity());
    for (const PoseEdge& edge : odometry) {
      add_edge(edge, poses[edge.a], poses[edge.b], 1.0, equations);
    }
    for (const PoseEdge& loop : loops) {
      const Pose2 &a = poses[loop.a], &b = poses[loop.b];
      add_edge(loop, a, b, loop_weight(loop, a, b), equations);
    }
    const auto step = equations.solve();
    if (!step) break;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const auto moved = step->knots.segment<3>(static_cast<Eigen::Index>(3 * k));
      poses[k].place_m += moved.head<2>();
      poses[k].yaw_rad = wrap_angle(poses[k].yaw_rad + moved[2]);
    }
    if (step->knots.cwiseAbs().maxCoeff() < 1e-6) break;
  }
  return weights();
}

}  // namespace pingvox
