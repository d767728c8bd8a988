#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pingvox/slam/slam_smoother.hpp"
#include "slam/smoother/fixed_sweeps.hpp"
#include "slam/smoother/slam_problem.hpp"
#include "slam/smoother/slam_solver.hpp"

namespace pingvox {

/// Solved again after so many sweeps, starting from the last solution.
inline constexpr std::size_t kSweepsOfStep = SlamOptions::kMinCausalSweeps;

/// The part of a trajectory that is still estimated, and what is left of the time before.
struct CausalWindow {
  explicit CausalWindow(std::uint64_t seed) : fixed(seed) {}

  /// Keeps what a solution says, and lets knots and sweeps older than the window leave.
  /// @param sweeps  of the solution
  /// @param longest  the most sweeps that stay
  /// @return how many sweeps left; nullopt: the solution is not determined, and the window is as before
  std::optional<std::size_t> keep(const SlamSolver& solver, std::span<const SweepEchoes> sweeps, std::size_t longest);
  /// Initial values from the window for a longer problem; dead reckoning after its end. REQUIRES poses.
  Unknowns continue_in(const SlamProblem& problem) const;
  /// The prior in the unknowns of a problem that starts with `start`. A new heading has the usual prior.
  std::optional<WindowPrior> prior_in(const SlamProblem& problem, const Unknowns& start) const;

  std::size_t first_sweep = 0;  ///< of the log
  std::vector<double> times_s;  ///< of the knots
  /// Of each step of the solution: how many knots it added.
  std::deque<std::size_t> steps;
  std::vector<Eigen::Vector3d> poses;  ///< of the knots: x, y, yaw
  std::vector<std::string> headings;
  Eigen::VectorXd globals;
  std::optional<WindowPrior> prior;  ///< its knot's last number is the yaw
  FixedSweeps fixed;
  std::size_t echoes = 0, left_knots = 0, left_echoes = 0;
  LargestSolution largest;

 private:
  /// The globals of a problem by those of the window, where they are: a heading may be new, or the main one.
  std::vector<std::optional<Eigen::Index>> known_globals(const SlamProblem& problem) const;
};

}  // namespace pingvox
