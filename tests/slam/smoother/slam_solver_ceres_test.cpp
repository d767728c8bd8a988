// Ceres solves the same problems: derivatives by differences over all unknowns at once, its own minimiser.

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "slam/basin.hpp"
#include "slam/smoother/echo_pairs.hpp"
#include "slam/smoother/slam_input.hpp"
#include "slam/smoother/slam_problem.hpp"
#include "slam/smoother/slam_solver.hpp"

namespace pingvox::test {
namespace {

/// Four sweeps of the basin, with a second compass that deviates otherwise.
class SlamSolverCeres : public testing::Test {
 protected:
  SlamSolverCeres() {
    options_.body_from_sonar = pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, basin_.sonar_yaw_rad);
    SweepAssembler assembler;
    for (const Beam& beam : basin_.beams()) {
      times_s_.push_back(beam.time_s);
      if (const auto sweep = assembler.add(beam)) sweeps_.push_back(sweep_echoes(*sweep, options_));
    }
    std::vector<NavSource> sources = basin_.sources();
    sources.push_back(sources[1]);
    sources.back().name = "other compass";
    for (NavSample& sample : sources.back().samples) sample.value.x() += 0.05 * std::sin(2.0 * sample.value.x());
    recording_.emplace(slam_input_of(times_s_, sweeps_, {std::move(sources)}, options_).value());
    const auto knots = knot_times(recording_->span, sweeps_, times_s_.size());
    problem_.emplace(knots.value(), recording_->navigation.velocity, recording_->navigation.headings);
    for (std::size_t s = 0; s < sweeps_.size(); ++s) {
      for (const EchoRun& run : sweeps_[s].runs) {
        const auto between = problem_->between_knots(run.time_s);
        if (!between) continue;
        echoes_.push_back({run, s, between->first, between->second, problem_->main_yaw_rad(run.time_s)});
      }
    }
  }

  SlamSolver solver() const { return solver_of(*problem_, *recording_, options_, problem_->dead_reckoning()); }

  std::vector<double> vector_of(const Unknowns& unknowns) const {
    std::vector<double> all;
    for (const Eigen::Vector3d& knot : unknowns.knots) all.insert(all.end(), knot.begin(), knot.end());
    all.insert(all.end(), unknowns.globals.begin(), unknowns.globals.end());
    return all;
  }
  Unknowns unknowns_of(const double* all) const {
    Unknowns unknowns = problem_->dead_reckoning();
    for (Eigen::Vector3d& knot : unknowns.knots) {
      knot = Eigen::Map<const Eigen::Vector3d>(all);
      all += 3;
    }
    unknowns.globals = Eigen::Map<const Eigen::VectorXd>(all, unknowns.globals.size());
    return unknowns;
  }

  /// Weighted residuals of motion, headings and what is believed, then those of pairs, whose weights and bulges are
  /// fixed, and whose normals turn with the yaw from what it is with `bulges` on.
  std::vector<double> residuals(const Unknowns& unknowns, std::span<const EchoPair> pairs,
                                const Unknowns& bulges) const {
    const Pose2 mount = pose2_of(options_.body_from_sonar);
    const auto ways = problem_->ways(unknowns), fixed_ways = problem_->ways(bulges);
    std::vector<double> all;
    for (const SlamProblem::Row& row : problem_->rows(unknowns, ways)) all.push_back(row.residual);
    const auto place_m = [&](const PlacedEcho& echo) -> Eigen::Vector2d {
      const EchoOnGround ground = place_echo(*problem_, mount, unknowns, ways, echo);
      return ground.at - ground.bulge + place_echo(*problem_, mount, bulges, fixed_ways, echo).bulge;
    };
    for (const EchoPair& pair : pairs) {
      const Eigen::Vector2d apart_m = place_m(echoes_[pair.a]) - place_m(echoes_[pair.b]);
      const auto turned_rad = [&](const PlacedEcho& echo) { return yaw_of(echo, unknowns) - yaw_of(echo, bulges); };
      const Eigen::Rotation2Dd turn(0.5 * (turned_rad(echoes_[pair.a]) + turned_rad(echoes_[pair.b])));
      all.push_back(std::sqrt(pair.weight) * (turn * pair.normal).dot(apart_m));
    }
    return all;
  }
  double cost(const Unknowns& unknowns, std::span<const EchoPair> pairs) const {
    double sum = 0.0;
    for (const double residual : residuals(unknowns, pairs, unknowns)) sum += 0.5 * residual * residual;
    return sum;
  }

  /// The least cost that Ceres finds.
  double least_cost(const Unknowns& start, std::span<const EchoPair> pairs, const Unknowns& bulges) const {
    std::vector<double> all = vector_of(start);
    const auto evaluate = [&](const double* const* at, double* out) {
      std::ranges::copy(residuals(unknowns_of(at[0]), pairs, bulges), out);
      return true;
    };
    auto function = std::make_unique<ceres::DynamicNumericDiffCostFunction<decltype(evaluate)>>(
        &evaluate, ceres::DO_NOT_TAKE_OWNERSHIP);
    function->AddParameterBlock(static_cast<int>(all.size()));
    function->SetNumResiduals(static_cast<int>(residuals(start, pairs, bulges).size()));
    ceres::Problem problem;
    problem.AddResidualBlock(function.release(), nullptr, all.data());
    ceres::Solver::Options options;
    options.max_num_iterations = 50;
    options.function_tolerance = 1e-12;
    options.linear_solver_type = ceres::DENSE_QR;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.BriefReport();
    return summary.final_cost;
  }

  Basin basin_{.duration_s = 40.0};
  SlamOptions options_;
  std::vector<double> times_s_;
  std::vector<SweepEchoes> sweeps_;
  std::optional<SlamInput> recording_;
  std::optional<SlamProblem> problem_;
  std::vector<PlacedEcho> echoes_;
};

// Kills wrong derivatives, and blocks of the normal equations that are forgotten or added twice.
TEST_F(SlamSolverCeres, FindsTheSameLeastCostWithoutPairs) {
  SlamSolver solver = this->solver();
  const Unknowns start = solver.unknowns();
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(solver.step(std::nullopt));
  const double least = least_cost(start, {}, start);
  EXPECT_LT(least, 0.9 * cost(start, {}));
  EXPECT_NEAR(cost(solver.unknowns(), {}), least, 1e-6 * least);
}

// The same of pairs. They are made anew in each step, so this asks for the minimum of those of the last one.
TEST_F(SlamSolverCeres, FindsTheSameLeastCostWithPairs) {
  SlamSolver solver = this->solver();
  for (const double gate_m : {10.0, 5.0, 3.0}) ASSERT_TRUE(solver.step(gate_m));
  Unknowns before = solver.unknowns();
  for (int i = 0; i < 20; ++i) {
    before = solver.unknowns();
    ASSERT_TRUE(solver.step(1.5));
  }
  const std::vector<EchoPair>& pairs = solver.pairs().pairs;
  ASSERT_GT(pairs.size(), 300U);
  const double least = least_cost(problem_->dead_reckoning(), pairs, before);
  EXPECT_LT(least, 0.9 * cost(problem_->dead_reckoning(), pairs));
  EXPECT_NEAR(cost(solver.unknowns(), pairs), least, 1e-6 * least);
}

}  // namespace
}  // namespace pingvox::test
