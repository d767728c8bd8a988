#pragma once

#include <vector>

#include "slam/least_squares/normal_equations.hpp"
#include "slam/smoother/slam_problem.hpp"

/// A vehicle does not change its velocity at random: a motion prior separates the noise of a DVL from motion.
namespace pingvox {

/// How much the velocity of the body changes, as far as its noise lets one see: standard deviation of either axis after
/// one second [m/s / sqrt(s)], 0.0005..1. The one that makes the measured velocities most likely.
double velocity_change(const VelocitySource& velocity);

/// Adds that the velocity, as measured and corrected by the knots, in the frame of its source, changes by no more from
/// the time between two knots to the next, unless it was measured to. REQUIRES equations with blocks for each knot and
/// the next but one.
void add_steady_motion(const SlamProblem& problem, const Unknowns& unknowns, const std::vector<SlamProblem::Way>& ways,
                       double change, NormalEquations& equations);

}  // namespace pingvox
