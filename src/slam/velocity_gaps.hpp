#pragma once

#include <span>

#include "slam/echo_pairs.hpp"
#include "slam/navigation.hpp"
#include "slam/slam_solver.hpp"

namespace pingvox {

/// Puts what the sonar says of the motion where a measured velocity is missing for longer than a sweep takes, and where
/// sweeps match.
/// @param velocity_from_sonar  seen from where the velocity is measured
/// @return for how long [s], all in all
double fill_velocity_gaps(std::span<const HeardSweep> sweeps, const SonarMount& velocity_from_sonar,
                          const HeadingSource& heading, VelocitySource& velocity);

}  // namespace pingvox
