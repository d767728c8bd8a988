#include "slam/smoother/map_solution.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "pingvox/geometry/pose2.hpp"
#include "slam/smoother/map_walls.hpp"
#include "slam/smoother/slam_problem.hpp"
#include "slam/smoother/slam_solver.hpp"
#include "slam/smoother/solution.hpp"

namespace pingvox {
namespace {

/// How far an echo may be from a wall, in each iteration.
constexpr std::array<double, 12> kMapGates_m = {1.5, 1.5, 1.5, 1.2, 1.0, 0.8, 0.6, 0.5, 0.5, 0.5, 0.5, 0.5};
/// An echo is on a wall so near to it; share of a sweep's echoes that have to be where the vehicle is where it seems.
constexpr double kOnWall_m = 0.15, kMinOnWalls = 0.6;

/// Knots where a trajectory has them, and headings off by as much as at the first. REQUIRES knots within its time.
Unknowns begin_near(const SlamProblem& problem, const Trajectory& near, const Eigen::Vector2d& velocity_place) {
  Unknowns start = problem.dead_reckoning();
  double error_rad = 0.0;
  for (std::size_t k = 0; k < problem.knots(); ++k) {
    const double time_s = problem.knot_times_s()[k];
    const Pose pose = near.at(time_s).value_or(Pose::Identity());
    const double yaw_rad = yaw_of(pose);
    error_rad += wrap_angle(yaw_rad - problem.main_yaw_rad(time_s) - error_rad);
    start.knots[k] << pose.translation().head<2>() + rotation2(yaw_rad) * velocity_place, error_rad;
  }
  const double first_s = problem.knot_times_s().front();
  const double yaw_rad = problem.main_yaw_rad(first_s) + start.knots.front().z();
  for (std::size_t s = 0; s < problem.headings().size(); ++s) {
    start.globals[static_cast<Eigen::Index>(global::heading(s))] =
        wrap_angle(problem.headings()[s].yaw_rad.at(first_s) - yaw_rad);
  }
  return start;
}

/// The priors in a map: as usual, but for the sonar's mount, which is known, and for where the headings' north
/// is, which is not.
WindowPrior prior_in_map(const SlamProblem& problem, const Unknowns& start) {
  constexpr double kPlace_m = 1.0, kYaw_rad = 1.0;
  const std::vector<Estimate> usual = problem.global_priors();
  const auto size = static_cast<Eigen::Index>(3 + usual.size());
  WindowPrior prior{start.knots.front(), start.globals, Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  Eigen::VectorXd deviations(size);
  deviations.head<3>() << kPlace_m, kPlace_m, kYaw_rad;
  for (std::size_t g = 0; g < usual.size(); ++g) {
    const auto i = static_cast<Eigen::Index>(g);
    prior.globals[i] = usual[g].value;
    deviations[3 + i] = usual[g].deviation;
  }
  deviations[3 + global::kSonarX] = deviations[3 + global::kSonarY] = kHeld;
  for (std::size_t s = 0; s < problem.headings().size(); ++s) {
    const auto constant = static_cast<Eigen::Index>(global::heading(s));
    prior.globals[constant] = start.globals[constant];
    deviations[3 + constant] = std::numbers::pi;
  }
  prior.information = deviations.cwiseAbs2().cwiseInverse().asDiagonal();
  return prior;
}

}  // namespace

Result<MapSolution> solve_in_map(SlamInput input, const NavLog& log, const SlamOptions& options,
                                 const DistanceField& map, const Trajectory& near) {
  input.span.from_s = std::max(input.span.from_s, near.poses().front().time_s);
  input.span.to_s = std::min(input.span.to_s, near.poses().back().time_s);
  if (!(input.span.from_s < input.span.to_s)) {
    return fail(Error::Code::kUnsupported, "the recording and the poses in the map do not overlap in time");
  }
  Result<std::vector<double>> times_s = knot_times(input.span, input.sweeps, input.beam_times_s.size());
  if (!times_s) return tl::unexpected(times_s.error());
  std::vector<HeadingSource> headings = input.navigation.headings;
  if (const NavSource* rate = log.best(NavQuantity::kTurnRate)) {
    auto turned = gyro_heading(*rate, mount_of(options.body_from_source, rate->name), headings.front());
    if (turned) headings.insert(headings.begin(), *std::move(turned));
  }
  SlamProblem problem(*std::move(times_s), input.navigation.velocity, std::move(headings), options.calibration);
  Unknowns start = begin_near(problem, near, place_of_velocity(input.navigation.velocity, options).head<2>());
  Before before;
  before.prior = prior_in_map(problem, start);
  SlamSolver solver = solver_of(std::move(problem), input, options, std::move(start), std::move(before));
  const MapWalls walls(map);
  solver.set_walls(walls);
  solver.expect_steady_motion();
  bool determined = true;
  for (const double gate_m : kMapGates_m) determined = determined && solver.step(gate_m);
  std::optional<std::vector<Eigen::Matrix3d>> of_knots;
  if (determined) of_knots = solver.knot_covariances();
  if (!of_knots) return fail(Error::Code::kUnsupported, "the map does not determine the trajectory");
  const double on_walls = solver.least_on_walls(kOnWall_m);
  if (on_walls < kMinOnWalls) {
    return fail(Error::Code::kUnsupported,
                fmt::format("the echoes do not fit the map: of a sweep, {:.0f} % are on walls", 100.0 * on_walls));
  }
  return solution_of(solver, options,
                     poses_at(input.beam_times_s, solver.problem(), solver.unknowns(), input.navigation.depth, options))
      .map([&](SlamSolution solution) {
        return MapSolution{std::move(solution.trajectory), std::move(solution.calibration),
                           covariances_of(solver, *of_knots, options), on_walls};
      });
}

}  // namespace pingvox
