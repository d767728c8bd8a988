#include "slam/causal/causal_window.hpp"

#include <algorithm>
#include <utility>

#include "pingvox/geometry/pose2.hpp"

namespace pingvox {

std::optional<std::size_t> CausalWindow::keep(const SlamSolver& solver, std::span<const SweepEchoes> sweeps,
                                              std::size_t longest) {
  const SlamProblem& problem = solver.problem();
  std::deque<std::size_t> all_steps = steps;
  all_steps.push_back(problem.knots() - std::max<std::size_t>(times_s.size(), 1));
  std::size_t leaving = 0;
  while (all_steps.size() * kSweepsOfStep > longest) {
    leaving += all_steps.front();
    all_steps.pop_front();
  }
  const auto next_prior = leaving > 0 ? solver.prior_at(leaving) : solver.before().prior;
  if (leaving > 0 && !next_prior) return std::nullopt;

  steps = std::move(all_steps);
  times_s = problem.knot_times_s();
  echoes = solver.echoes();
  largest.knots = std::max(largest.knots, problem.knots());
  largest.echoes = std::max(largest.echoes, solver.echoes() + solver.fixed_echoes());
  largest.pairs = std::max(largest.pairs, solver.pairs().pairs.size());
  const auto yaw_rad = [&](std::size_t knot) { return problem.main_yaw_rad(times_s[knot]); };
  poses = solver.unknowns().knots;
  for (std::size_t k = 0; k < poses.size(); ++k) poses[k].z() += yaw_rad(k);
  globals = solver.unknowns().globals;
  headings.clear();
  for (const HeadingSource& heading : problem.headings()) headings.push_back(heading.name);
  prior = next_prior;
  if (prior) prior->knot.z() += yaw_rad(leaving);
  if (leaving == 0) return 0;
  std::size_t ended = 0;
  while (ended < sweeps.size() && 0.5 * (sweeps[ended].from_s + sweeps[ended].to_s) < times_s[leaving]) ++ended;
  for (FixedSweep& sweep : solver.hold(ended)) {
    left_echoes += sweep.echoes.size();
    echoes -= sweep.echoes.size();
    fixed.add(std::move(sweep));
  }
  left_knots += leaving;
  first_sweep += ended;
  times_s.erase(times_s.begin(), times_s.begin() + static_cast<std::ptrdiff_t>(leaving));
  poses.erase(poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(leaving));
  return ended;
}

std::vector<std::optional<Eigen::Index>> CausalWindow::known_globals(const SlamProblem& problem) const {
  std::vector<std::optional<Eigen::Index>> known;
  for (std::size_t g = 0; g < global::kHeadings; ++g) known.emplace_back(static_cast<Eigen::Index>(g));
  for (const HeadingSource& heading : problem.headings()) {
    const auto same = std::ranges::find(headings, heading.name);
    for (std::size_t i = 0; i < global::kOfHeading; ++i) {
      const std::size_t from = global::heading(static_cast<std::size_t>(same - headings.begin())) + i;
      known.push_back(same == headings.end() ? std::nullopt : std::optional(static_cast<Eigen::Index>(from)));
    }
  }
  return known;
}

Unknowns CausalWindow::continue_in(const SlamProblem& problem) const {
  Unknowns start = problem.dead_reckoning();
  const auto known = known_globals(problem);
  for (std::size_t g = 0; g < known.size(); ++g) {
    if (known[g]) start.globals[static_cast<Eigen::Index>(g)] = globals[*known[g]];
  }
  double error_rad = 0.0;
  for (std::size_t k = 0; k < problem.knots(); ++k) {
    if (k < poses.size()) {
      start.knots[k] = poses[k];
      const double error = poses[k].z() - problem.main_yaw_rad(problem.knot_times_s()[k]);
      error_rad += wrap_angle(error - error_rad);
    }
    // After the end of the window, as at its end.
    start.knots[k].z() = error_rad;
  }
  const std::vector<SlamProblem::Way> moved = problem.ways(start);
  for (std::size_t k = poses.size() - 1; k + 1 < problem.knots(); ++k) {
    start.knots[k + 1].head<2>() = start.knots[k].head<2>() + moved[k].moved;
  }
  return start;
}

std::optional<WindowPrior> CausalWindow::prior_in(const SlamProblem& problem, const Unknowns& start) const {
  if (!prior) return std::nullopt;
  const WindowPrior& from = *prior;
  const auto known = known_globals(problem);
  const auto size = static_cast<Eigen::Index>(3 + known.size());
  const std::vector<Estimate> usual = problem.global_priors();
  WindowPrior moved{from.knot, start.globals, Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  const double error_rad = start.knots.front().z();
  moved.knot.z() = error_rad + wrap_angle(from.knot.z() - problem.main_yaw_rad(times_s.front()) - error_rad);
  std::vector<std::optional<Eigen::Index>> places = {0, 1, 2};
  for (const auto& place : known) places.push_back(place ? std::optional(*place + 3) : std::nullopt);
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto& row = places[static_cast<std::size_t>(i)];
    if (!row) {
      const Estimate& believed = usual[static_cast<std::size_t>(i - 3)];
      moved.globals[i - 3] = believed.value;
      moved.information(i, i) = 1.0 / (believed.deviation * believed.deviation);
      continue;
    }
    if (i >= 3) moved.globals[i - 3] = from.globals[*row - 3];
    moved.gradient[i] = from.gradient[*row];
    for (Eigen::Index j = 0; j < size; ++j) {
      const auto& column = places[static_cast<std::size_t>(j)];
      if (column) moved.information(i, j) = from.information(*row, *column);
    }
  }
  return moved;
}

}  // namespace pingvox
