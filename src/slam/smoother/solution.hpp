#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "slam/smoother/slam_input.hpp"
#include "slam/smoother/slam_problem.hpp"
#include "slam/smoother/slam_solver.hpp"

/// What is read off a solution of the least-squares problem.
namespace pingvox {

/// The body's pose at those of the times that rise and are within the time of the knots.
std::vector<StampedPose> poses_at(std::span<const double> times_s, const SlamProblem& problem, const Unknowns& unknowns,
                                  const std::optional<TimeSeries>& depth, const SlamOptions& options);

/// Of the body, whose origin is carried by the place of the velocity's source.
std::vector<PoseCovariance> covariances_of(const SlamSolver& solver, const std::vector<Eigen::Matrix3d>& of_knots,
                                           const SlamOptions& options);

/// Shifts poses so that the first is at x, y = 0.
void begin_at_origin(std::vector<StampedPose>& poses);

/// Times of measured velocities in pauses of the sonar in which velocity and heading go on.
std::vector<double> times_in_pauses(const SlamInput& recording);

/// With all of the report but beams and sweeps, and without covariances.
/// @param poses  of the beams, and others
/// @param least_gap_s  the trajectory has no shorter gap
/// @return kUnsupported without poses
Result<SlamSolution> solution_of(const SlamSolver& solver, const SlamOptions& options, std::vector<StampedPose> poses,
                                 double least_gap_s = 0.0);

/// What the report says of the velocity. @param span  of the trajectory
void report_velocity(const VelocitySource& velocity, const TimeSpan& span, VelocityReport& report);

}  // namespace pingvox
