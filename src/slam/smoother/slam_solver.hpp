#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pingvox/slam/pose_graph.hpp"
#include "slam/least_squares/normal_equations.hpp"
#include "slam/smoother/echo_pairs.hpp"
#include "slam/smoother/fixed_sweeps.hpp"
#include "slam/smoother/map_walls.hpp"
#include "slam/smoother/slam_problem.hpp"
#include "slam/sweeps/sweep_echoes.hpp"

namespace pingvox {

/// The widest gate of pairs where the velocity leads from sweep to sweep, as a share of the sonar's reach: echoes that
/// are farther apart are of two things, as of two boulders. Gaps of the velocity widen it by how far they may lead
/// astray.
inline constexpr double kGateOfReach = 0.2;

/// What a problem that begins within a recording keeps of the time before.
struct Before {
  std::size_t sweeps = 0;              ///< that left the problem
  std::optional<WindowPrior> prior;    ///< nullopt: no knot left
  const FixedSweeps* fixed = nullptr;  ///< nullptr: none
};

/// A loop with a sweep that left the problem: `b` of the edge is not a knot, but where that sweep stays.
struct FixedLoop {
  PoseEdge edge;
  Pose2 fixed;
};

/// The least-squares problem of sweeps, and its iterations.
class SlamSolver {
 public:
  SlamSolver(SlamProblem problem, const Pose2& mount, std::span<const SweepEchoes> sweeps, std::uint64_t seed,
             Unknowns start, Before before = {});

  /// In the steps to come, echoes are matched with the walls of a known map instead of each other. They must outlive
  /// the solver.
  void set_walls(const MapWalls& walls) { walls_ = &walls; }
  /// In the steps to come, the vehicle is taken to move as steadily as its velocity says. Not for `prior_at`.
  void expect_steady_motion();

  /// One Gauss-Newton step. False: the problem does not determine its unknowns, and they stay.
  /// @param gate_m  how far apart the echoes of a pair may be; nullopt: without pairs. Without a measured velocity it
  /// is less for a sonar that reaches less than 20 m, in proportion.
  bool step(std::optional<double> gate_m);

  /// Edges between knots that count in the steps to come, by Cauchy's function.
  void set_loops(std::vector<PoseEdge> loops, std::vector<FixedLoop> fixed = {}) {
    loops_ = std::move(loops);
    fixed_loops_ = std::move(fixed);
  }
  const std::vector<PoseEdge>& loops() const { return loops_; }

  /// The body's yaw at a knot, and where the velocity's source is.
  Pose2 pose_of_knot(std::size_t knot) const;
  /// All echoes of the sweeps within the time of the knots.
  std::vector<EchoOnGround> ground() const;
  /// Where the echoes of a sweep that left are.
  std::vector<Eigen::Vector2d> ground_of(const FixedSweep& sweep) const;
  /// Where the echoes of each sweep begin, those of fixed ones first, and the end of the last.
  const std::vector<std::size_t>& sweeps() const { return sweeps_; }
  /// The knots around the middle of each sweep, and the share of the way between them.
  const std::vector<std::pair<std::size_t, double>>& sweep_middles() const { return sweep_middles_; }

  const SlamProblem& problem() const { return problem_; }
  const Before& before() const { return before_; }
  const Unknowns& unknowns() const { return unknowns_; }
  const Eigen::MatrixXd& global_covariance() const { return global_covariance_; }
  /// Of x, y [m] and yaw [rad] at each knot, with the pairs of the last step. nullopt: not determined.
  std::optional<std::vector<Eigen::Matrix3d>> knot_covariances() const;
  const EchoPairs& pairs() const { return pairs_; }
  /// The least share of the echoes of a sweep that are within `near_m` of the wall that they are matched with; of
  /// sweeps with 20 echoes or more, 1 without any.
  double least_on_walls(double near_m) const;
  /// The prior on a knot and the globals from the problem of the last step, with earlier knots marginalised. Pairs of
  /// echoes before and after the knot are left out: they are made again with the sweeps that are fixed. nullopt: not
  /// determined.
  std::optional<WindowPrior> prior_at(std::size_t knot) const;
  /// The first sweeps of those of the constructor as they are now. REQUIRES as many.
  std::vector<FixedSweep> hold(std::size_t sweeps) const;

  double reach_m() const { return reach_m_; }                            ///< see reach_of
  std::size_t echoes() const { return echoes_.size() - fixed_echoes_; }  ///< but those that are fixed
  std::size_t fixed_echoes() const { return fixed_echoes_; }

 private:
  NormalEquations equations(const std::vector<SlamProblem::Way>& ways, const std::vector<EchoOnGround>& ground) const;
  /// In the order of sweeps().
  std::vector<SweepPlace> sweep_places() const;
  /// The knot before the second echo of a pair; the first one's where that is fixed, for then it moves with no knot.
  std::size_t second_knot(const EchoPair& pair) const { return echoes_[echoes_[pair.b].fixed ? pair.a : pair.b].knot; }
  void add_pairs(const std::vector<EchoOnGround>& ground, NormalEquations& equations) const;
  void add_walls(const std::vector<EchoOnGround>& ground, NormalEquations& equations) const;

  SlamProblem problem_;
  Pose2 mount_;
  std::uint64_t seed_;
  Unknowns unknowns_;
  std::vector<PlacedEcho> echoes_;
  std::vector<std::size_t> sweeps_;  ///< where the echoes of each begin, those that are fixed first, and the end
  std::vector<std::pair<std::size_t, double>> sweep_middles_;
  Before before_;
  std::vector<SweepPlace> fixed_places_;
  std::size_t fixed_echoes_ = 0;
  double reach_m_ = 0.0, scale_ = 1.0;
  EchoPairs pairs_;
  const MapWalls* walls_ = nullptr;
  std::optional<double> velocity_change_;  ///< of a vehicle that moves steadily
  std::vector<WallMatch> wall_matches_;
  std::vector<PoseEdge> loops_;
  std::vector<FixedLoop> fixed_loops_;
  Eigen::MatrixXd global_covariance_;
};

}  // namespace pingvox
