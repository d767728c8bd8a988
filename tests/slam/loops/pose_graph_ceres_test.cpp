// Ceres solves the same graphs: residuals written anew, derivatives by automatic differentiation, its own minimiser.

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <random>

#include "pingvox/slam/pose_graph.hpp"
#include "tests/support/uniform.hpp"

namespace pingvox::test {
namespace {

class EdgeCost {
 public:
  explicit EdgeCost(const PoseEdge& edge)
      : edge_(edge), root_(Eigen::LLT<Eigen::Matrix3d>(edge.information).matrixL().transpose()) {}

  template <class T>
  bool operator()(const T* a, const T* b, T* residual) const {
    using std::atan2, std::cos, std::sin;
    const T east = b[0] - a[0], north = b[1] - a[1], turn = b[2] - a[2] - T(edge_.a_from_b.yaw_rad);
    const T c = cos(a[2]), s = sin(a[2]);
    const std::array<T, 3> off = {c * east + s * north - T(edge_.a_from_b.place_m.x()),
                                  c * north - s * east - T(edge_.a_from_b.place_m.y()), atan2(sin(turn), cos(turn))};
    for (int row = 0; row < 3; ++row) {
      residual[row] = T(0.0);
      for (int column = row; column < 3; ++column) {
        residual[row] += T(root_(row, column)) * off[static_cast<std::size_t>(column)];
      }
    }
    return true;
  }

 private:
  PoseEdge edge_;
  Eigen::Matrix3d root_;
};

struct Graph {
  std::vector<Pose2> poses;  ///< where to begin
  std::vector<PoseEdge> odometry, loops;
};

Eigen::Matrix3d random_information(std::mt19937_64& random) {
  Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 9; ++i) root(i / 3, i % 3) = uniform(random, -1.0, 1.0);
  const Eigen::Matrix3d covariance = 0.02 * root * root.transpose() + 0.01 * Eigen::Matrix3d::Identity();
  return covariance.inverse();
}

/// A walk with right loops, and some that are wrong by metres.
Graph random_graph(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto noise = [&](double size) {
    return Pose2{{uniform(random, -size, size), uniform(random, -size, size)}, uniform(random, -size, size) * 0.3};
  };
  constexpr std::size_t kPoses = 60;
  std::vector<Pose2> truth = {{}};
  while (truth.size() < kPoses) truth.push_back(truth.back() * Pose2{{1.0, 0.1}, uniform(random, -0.3, 0.6)});
  const auto edge = [&](std::size_t a, std::size_t b, double size) {
    return PoseEdge{a, b, truth[a].inverse() * truth[b] * noise(size), random_information(random)};
  };
  Graph graph;
  graph.poses = {truth.front()};
  for (std::size_t i = 0; i + 1 < kPoses; ++i) {
    graph.odometry.push_back(edge(i, i + 1, 0.05));
    graph.poses.push_back(graph.poses.back() * graph.odometry.back().a_from_b);
  }
  for (int i = 0; i < 12; ++i) {
    const auto a = static_cast<std::size_t>(uniform(random, 0.0, 30.0));
    graph.loops.push_back(edge(a, a + 20, i % 6 == 5 ? 3.0 : 0.1));
  }
  return graph;
}

/// The graph as a problem of Ceres on these poses. Loops count by Cauchy's function, half at two standard deviations.
class Reference {
 public:
  Reference(const Graph& graph, const std::vector<Pose2>& poses) {
    for (const Pose2& pose : poses) poses_.push_back({pose.place_m.x(), pose.place_m.y(), pose.yaw_rad});
    for (const PoseEdge& edge : graph.odometry) add(edge, nullptr);
    for (const PoseEdge& edge : graph.loops) add(edge, new ceres::CauchyLoss(2.0));
    problem_.SetParameterBlockConstant(poses_.front().data());
  }

  double cost() {
    double cost = 0.0;
    EXPECT_TRUE(problem_.Evaluate({}, &cost, nullptr, nullptr, nullptr));
    return cost;
  }
  void solve() {
    ceres::Solver::Options options;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-14;
    options.linear_solver_type = ceres::DENSE_QR;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.BriefReport();
  }

 private:
  void add(const PoseEdge& edge, ceres::LossFunction* loss) {
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<EdgeCost, 3, 3, 3>(new EdgeCost(edge)), loss,
                              poses_[edge.a].data(), poses_[edge.b].data());
  }

  std::vector<std::array<double, 3>> poses_;
  ceres::Problem problem_;
};

// Kills wrong residuals, derivatives, weights and an end too early: the costs of two minimisers agree.
TEST(PoseGraphCeres, FindsTheSameLeastCost) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const Graph graph = random_graph(seed);
    std::vector<Pose2> poses = graph.poses;
    solve_pose_graph(poses, graph.odometry, graph.loops);
    Reference reference(graph, graph.poses);
    const double before = reference.cost();
    reference.solve();
    const double least = reference.cost();
    EXPECT_LT(least, 0.9 * before);
    EXPECT_NEAR(Reference(graph, poses).cost(), least, 1e-6 * least);
  }
}

}  // namespace
}  // namespace pingvox::test
