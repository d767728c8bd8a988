#include "slam/smoother/slam_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "slam/loops/pose_edges.hpp"
#include "slam/smoother/steady_motion.hpp"

namespace pingvox {
namespace {

/// Distances of pairs are for a sonar that reaches this far, and farther.
constexpr double kUsualReach_m = 20.0;

void add_row(const SlamProblem::Row& row, NormalEquations& equations) {
  const auto a = static_cast<Eigen::Index>(3 * row.knot), globals = equations.corner.cols();
  equations.add_block(row.knot, row.knot, row.by_knot * row.by_knot.transpose());
  equations.add_block(row.knot + 1, row.knot + 1, row.by_next * row.by_next.transpose());
  equations.add_block(row.knot + 1, row.knot, row.by_next * row.by_knot.transpose());
  equations.border.middleRows<3>(a) += row.by_knot * row.by_globals.transpose();
  equations.border.middleRows<3>(a + 3) += row.by_next * row.by_globals.transpose();
  equations.corner += row.by_globals * row.by_globals.transpose();
  equations.gradient.segment<3>(a) += row.residual * row.by_knot;
  equations.gradient.segment<3>(a + 3) += row.residual * row.by_next;
  equations.gradient.tail(globals) += row.residual * row.by_globals;
}

/// Gradient of what is known from before, where the first knot and the globals are now.
Eigen::VectorXd gradient_at(const WindowPrior& prior, const Eigen::Vector3d& knot, const Eigen::VectorXd& globals) {
  Eigen::VectorXd off(3 + globals.size());
  off << knot - prior.knot, globals - prior.globals;
  return prior.gradient + prior.information * off;
}

}  // namespace

SlamSolver::SlamSolver(SlamProblem problem, const Pose2& mount, std::span<const SweepEchoes> sweeps, std::uint64_t seed,
                       Unknowns start, Before before)
    : problem_(std::move(problem)),
      mount_(mount),
      seed_(seed),
      unknowns_(std::move(start)),
      before_(std::move(before)) {
  if (before_.prior) problem_.begin_with_prior();
  for (const SweepEchoes& sweep : sweeps) {
    const double middle_s =
        std::clamp(0.5 * (sweep.from_s + sweep.to_s), problem_.knot_times_s().front(), problem_.knot_times_s().back());
    sweep_middles_.push_back(*problem_.between_knots(middle_s));
  }
  reach_m_ = reach_of(sweeps);
  if (problem_.velocity().by_sonar) scale_ = std::min(1.0, reach_m_ / kUsualReach_m);
  sweeps_.push_back(0);
  if (before_.fixed != nullptr) {
    for (const auto& fixed : before_.fixed->partners(sweep_places(), scale_ * kFarReach_m)) {
      fixed_places_.push_back(fixed->place);
      echoes_.insert(echoes_.end(), fixed->echoes.begin(), fixed->echoes.end());
      sweeps_.push_back(echoes_.size());
    }
  }
  fixed_echoes_ = echoes_.size();
  for (const SweepEchoes& sweep : sweeps) {
    for (const EchoRun& run : sweep.runs) {
      const auto between = problem_.between_knots(run.time_s);
      if (!between) continue;
      echoes_.push_back({run, sweeps_.size() - 1, between->first, between->second, problem_.main_yaw_rad(run.time_s)});
    }
    sweeps_.push_back(echoes_.size());
  }
}

std::vector<SweepPlace> SlamSolver::sweep_places() const {
  std::vector<SweepPlace> places = fixed_places_;
  for (const auto& [knot, share] : sweep_middles_) {
    const std::size_t number = before_.sweeps + places.size() - fixed_places_.size();
    places.push_back({number, unknowns_.at(knot, share).head<2>()});
  }
  return places;
}

Pose2 SlamSolver::pose_of_knot(std::size_t knot) const {
  const Eigen::Vector3d& state = unknowns_.knots[knot];
  return {state.head<2>(), wrap_angle(problem_.main_yaw_rad(problem_.knot_times_s()[knot]) + state.z())};
}

std::vector<EchoOnGround> SlamSolver::ground() const {
  return place_echoes(problem_, mount_, unknowns_, problem_.ways(unknowns_), echoes_, sweeps_);
}

void SlamSolver::expect_steady_motion() {
  velocity_change_ = velocity_change(problem_.velocity());
}

std::vector<Eigen::Vector2d> SlamSolver::ground_of(const FixedSweep& sweep) const {
  std::vector<Eigen::Vector2d> places_m;
  for (const PlacedEcho& echo : sweep.echoes) {
    places_m.push_back(place_echo(problem_, mount_, unknowns_, {}, echo).at);
  }
  return places_m;
}

bool SlamSolver::step(std::optional<double> gate_m) {
  const std::vector<SlamProblem::Way> ways = problem_.ways(unknowns_);
  std::vector<EchoOnGround> ground;
  pairs_ = {};
  wall_matches_.clear();
  if (gate_m && walls_ != nullptr) {
    ground = place_echoes(problem_, mount_, unknowns_, ways, echoes_, sweeps_);
    wall_matches_ = match_walls(echoes_, ground, *walls_, *gate_m);
  } else if (gate_m) {
    ground = place_echoes(problem_, mount_, unknowns_, ways, echoes_, sweeps_);
    pairs_ = echo_pairs(echoes_, ground, sweeps_, sweep_places(), {seed_, scale_ * *gate_m, scale_});
    // In order of the knots that they join.
    std::ranges::sort(pairs_.pairs, {}, [&](const EchoPair& pair) {
      return std::array<std::size_t, 4>{echoes_[pair.a].knot, second_knot(pair), pair.a, pair.b};
    });
  }
  const std::optional<NormalEquations::Step> step = equations(ways, ground).solve();
  if (!step) return false;
  for (std::size_t k = 0; k < problem_.knots(); ++k) {
    unknowns_.knots[k] += step->knots.segment<3>(static_cast<Eigen::Index>(3 * k));
  }
  unknowns_.globals += step->globals;
  global_covariance_ = step->global_covariance;
  return true;
}

std::optional<std::vector<Eigen::Matrix3d>> SlamSolver::knot_covariances() const {
  std::vector<SlamProblem::Way> ways = problem_.ways(unknowns_);
  for (SlamProblem::Way& way : ways) way.deviation_m = way.with_steady_m;
  std::vector<EchoOnGround> ground;
  if (!pairs_.pairs.empty() || !wall_matches_.empty()) {
    ground = place_echoes(problem_, mount_, unknowns_, ways, echoes_, sweeps_);
  }
  return equations(ways, ground).knot_covariances();
}

NormalEquations SlamSolver::equations(const std::vector<SlamProblem::Way>& ways,
                                      const std::vector<EchoOnGround>& ground) const {
  const auto joined = [&](const EchoPair& pair) {
    return std::pair{static_cast<std::uint32_t>(echoes_[pair.a].knot), static_cast<std::uint32_t>(second_knot(pair))};
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> shared;
  for (std::uint32_t k = 0; k + 1 < problem_.knots(); ++k) shared.emplace_back(k, k + 1);
  for (std::uint32_t k = 0; velocity_change_ && k + 2 < problem_.knots(); ++k) shared.emplace_back(k, k + 2);
  for (std::size_t i = 0; i < pairs_.pairs.size(); ++i) {
    const auto [a, b] = joined(pairs_.pairs[i]);
    if (i > 0 && joined(pairs_.pairs[i - 1]) == std::pair{a, b}) continue;
    for (const std::uint32_t x : {a, a + 1}) {
      for (const std::uint32_t y : {b, b + 1}) shared.emplace_back(x, y);
    }
  }
  for (const PoseEdge& loop : loops_) {
    shared.emplace_back(static_cast<std::uint32_t>(loop.a), static_cast<std::uint32_t>(loop.b));
  }
  NormalEquations equations(problem_.knots(), problem_.globals(), shared);
  for (const SlamProblem::Row& row : problem_.rows(unknowns_, ways)) add_row(row, equations);
  add_pairs(ground, equations);
  add_walls(ground, equations);
  if (velocity_change_) add_steady_motion(problem_, unknowns_, ways, *velocity_change_, equations);
  for (const PoseEdge& loop : loops_) {
    const Pose2 a = pose_of_knot(loop.a), b = pose_of_knot(loop.b);
    add_edge(loop, a, b, loop_weight(loop, a, b), equations);
  }
  for (const auto& [loop, fixed] : fixed_loops_) {
    const Pose2 a = pose_of_knot(loop.a);
    add_edge_to_fixed(loop, a, fixed, loop_weight(loop, a, fixed), equations);
  }
  if (before_.prior) {
    const WindowPrior& prior = *before_.prior;
    const auto globals = static_cast<Eigen::Index>(problem_.globals());
    const Eigen::VectorXd gradient = gradient_at(prior, unknowns_.knots.front(), unknowns_.globals);
    equations.add_block(0, 0, prior.information.topLeftCorner<3, 3>());
    equations.border.topRows<3>() += prior.information.topRightCorner(3, globals);
    equations.corner += prior.information.bottomRightCorner(globals, globals);
    equations.gradient.head<3>() += gradient.head<3>();
    equations.gradient.tail(globals) += gradient.tail(globals);
  }
  return equations;
}

std::optional<WindowPrior> SlamSolver::prior_at(std::size_t knot) const {
  constexpr std::size_t kAtOnce = 16;  // few, for the equations are dense
  assert(!velocity_change_);
  const std::vector<SlamProblem::Way> ways = problem_.ways(unknowns_);
  const std::vector<SlamProblem::Row> rows = problem_.rows(unknowns_, ways);
  std::vector<EchoOnGround> ground;
  if (!pairs_.pairs.empty()) ground = place_echoes(problem_, mount_, unknowns_, ways, echoes_, sweeps_);
  const auto globals = static_cast<Eigen::Index>(problem_.globals());
  std::optional<WindowPrior> prior = before_.prior;
  for (std::size_t first = 0; first < knot;) {
    const std::size_t last = std::min(first + kAtOnce, knot);
    const auto leaving = static_cast<Eigen::Index>(3 * (last - first)), size = leaving + 3 + globals;
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
    const auto add = [&](const Eigen::VectorXd& by, double residual, double weight) {
      information.selfadjointView<Eigen::Lower>().rankUpdate(by, weight);
      gradient += weight * residual * by;
    };
    for (const SlamProblem::Row& row : rows) {
      if (row.knot < first || row.knot >= last) continue;
      Eigen::VectorXd by = Eigen::VectorXd::Zero(size);
      by.segment<3>(static_cast<Eigen::Index>(3 * (row.knot - first))) = row.by_knot;
      by.segment<3>(static_cast<Eigen::Index>(3 * (row.knot - first + 1))) = row.by_next;
      by.tail(globals) = row.by_globals;
      add(by, row.residual, 1.0);
    }
    for (const EchoPair& pair : pairs_.pairs) {
      const std::size_t a = echoes_[pair.a].knot, b = second_knot(pair);
      if (std::min(a, b) < first || std::max(a, b) >= last) continue;
      const PairRow row = pair_row(echoes_[pair.a], ground[pair.a], echoes_[pair.b], ground[pair.b], unknowns_, pair);
      Eigen::VectorXd by = Eigen::VectorXd::Zero(size);
      by.segment<6>(static_cast<Eigen::Index>(3 * (a - first))) += row.by.segment<6>(0);
      by.segment<6>(static_cast<Eigen::Index>(3 * (b - first))) += row.by.segment<6>(6);
      by.segment<3>(leaving + 3 + Eigen::Index{global::kWall}) = row.by.tail<3>();
      add(by, row.distance_m, pair.weight);
    }
    information = Eigen::MatrixXd(information.selfadjointView<Eigen::Lower>());
    if (prior) {
      const Eigen::VectorXd of_prior = gradient_at(*prior, unknowns_.knots[first], unknowns_.globals);
      const Eigen::MatrixXd& known = prior->information;
      information.topLeftCorner<3, 3>() += known.topLeftCorner<3, 3>();
      information.topRightCorner(3, globals) += known.topRightCorner(3, globals);
      information.bottomLeftCorner(globals, 3) += known.bottomLeftCorner(globals, 3);
      information.bottomRightCorner(globals, globals) += known.bottomRightCorner(globals, globals);
      gradient.head<3>() += of_prior.head<3>();
      gradient.tail(globals) += of_prior.tail(globals);
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(information.topLeftCorner(leaving, leaving));
    if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
    const Eigen::Index staying = size - leaving;
    const Eigen::MatrixXd across = information.bottomLeftCorner(staying, leaving);
    const Eigen::MatrixXd left =
        information.bottomRightCorner(staying, staying) - across * factor.solve(Eigen::MatrixXd(across.transpose()));
    prior = WindowPrior{unknowns_.knots[last], unknowns_.globals, 0.5 * (left + left.transpose()),
                        gradient.tail(staying) - across * factor.solve(Eigen::VectorXd(gradient.head(leaving)))};
    if (!prior->information.allFinite() || !prior->gradient.allFinite()) return std::nullopt;
    first = last;
  }
  return prior;
}

std::vector<FixedSweep> SlamSolver::hold(std::size_t sweeps) const {
  const std::vector<SlamProblem::Way> ways = problem_.ways(unknowns_);
  const std::vector<SweepPlace> places = sweep_places();
  std::vector<FixedSweep> fixed;
  for (std::size_t s = fixed_places_.size(); s < fixed_places_.size() + sweeps; ++s) {
    FixedSweep sweep{places[s], {}};
    sweep.place.is_held = true;
    for (std::size_t i = sweeps_[s]; i < sweeps_[s + 1]; ++i) {
      PlacedEcho echo = echoes_[i];
      const EchoOnGround ground = place_echo(problem_, mount_, unknowns_, ways, echo);
      echo.fixed = Pose2{ground.at - ground.arm, yaw_of(echo, unknowns_)};
      sweep.echoes.push_back(echo);
    }
    fixed.push_back(std::move(sweep));
  }
  return fixed;
}

/// Sums up the pairs that join the same knots before they are added.
void SlamSolver::add_pairs(const std::vector<EchoOnGround>& ground, NormalEquations& equations) const {
  using Sum = Eigen::Matrix<double, 15, 16>;  // J'J, and J'r as its last column
  const auto& pairs = pairs_.pairs;
  for (std::size_t first = 0, end = 0; first < pairs.size(); first = end) {
    const std::size_t a = echoes_[pairs[first].a].knot, b = second_knot(pairs[first]);
    Sum sum = Sum::Zero();
    for (end = first; end < pairs.size() && echoes_[pairs[end].a].knot == a && second_knot(pairs[end]) == b; ++end) {
      const EchoPair& pair = pairs[end];
      const PairRow row = pair_row(echoes_[pair.a], ground[pair.a], echoes_[pair.b], ground[pair.b], unknowns_, pair);
      Eigen::Matrix<double, 16, 1> wide;
      wide << row.by, row.distance_m;
      sum.noalias() += (pair.weight * row.by) * wide.transpose();
    }
    const std::array<std::size_t, 4> knots = {a, a + 1, b, b + 1};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto row = static_cast<Eigen::Index>(3 * knots[i]), from = static_cast<Eigen::Index>(3 * i);
      for (std::size_t j = 0; j < 4; ++j) {
        // Each block of the lower triangle once; all four where both echoes are of one knot.
        if (knots[i] < knots[j]) continue;
        equations.add_block(knots[i], knots[j], sum.block<3, 3>(from, static_cast<Eigen::Index>(3 * j)));
      }
      equations.border.block<3, 3>(row, global::kWall) += sum.block<3, 3>(from, 12);
      equations.gradient.segment<3>(row) += sum.block<3, 1>(from, 15);
    }
    equations.corner.block<3, 3>(global::kWall, global::kWall) += sum.block<3, 3>(12, 12);
    equations.gradient.segment<3>(equations.border.rows() + Eigen::Index{global::kWall}) += sum.block<3, 1>(12, 15);
  }
}

double SlamSolver::least_on_walls(double near_m) const {
  constexpr std::size_t kFew = 20;
  std::vector<std::size_t> near(sweeps_.size() - 1, 0);
  for (const WallMatch& match : wall_matches_) {
    if (std::abs(match.distance_m) <= near_m) ++near[echoes_[match.echo].sweep];
  }
  double least = 1.0;
  for (std::size_t s = 0; s < near.size(); ++s) {
    const std::size_t count = sweeps_[s + 1] - sweeps_[s];
    if (count >= kFew) least = std::min(least, static_cast<double>(near[s]) / static_cast<double>(count));
  }
  return least;
}

void SlamSolver::add_walls(const std::vector<EchoOnGround>& ground, NormalEquations& equations) const {
  for (const WallMatch& match : wall_matches_) {
    const PlacedEcho& echo = echoes_[match.echo];
    const EchoRow row = echo_row(echo, ground[match.echo], unknowns_, match.normal);
    const Eigen::Matrix<double, 6, 6> square = match.weight * row.by_knots * row.by_knots.transpose();
    equations.add_block(echo.knot, echo.knot, square.topLeftCorner<3, 3>());
    equations.add_block(echo.knot + 1, echo.knot + 1, square.bottomRightCorner<3, 3>());
    equations.add_block(echo.knot + 1, echo.knot, square.bottomLeftCorner<3, 3>());
    const auto first = static_cast<Eigen::Index>(3 * echo.knot);
    equations.border.block<6, 3>(first, global::kWall) += match.weight * row.by_knots * row.by_globals.transpose();
    equations.corner.block<3, 3>(global::kWall, global::kWall) +=
        match.weight * row.by_globals * row.by_globals.transpose();
    equations.gradient.segment<6>(first) += match.weight * match.distance_m * row.by_knots;
    equations.gradient.segment<3>(equations.border.rows() + Eigen::Index{global::kWall}) +=
        match.weight * match.distance_m * row.by_globals;
  }
}

}  // namespace pingvox
