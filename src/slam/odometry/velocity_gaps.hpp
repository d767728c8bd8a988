#pragma once

#include <span>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "pingvox/nav/time_span.hpp"
#include "slam/sweeps/sweep_echoes.hpp"

namespace pingvox {

/// Puts what the sonar says of the motion where a measured velocity is missing for longer than a sweep takes, and where
/// sweeps match.
/// @param span  before the first and after the last sample the velocity is missing within this, as far as the heading
///              is known
/// @param velocity_from_sonar  seen from where the velocity is measured
/// @return where that was
std::vector<TimeSpan> fill_velocity_gaps(std::span<const SweepEchoes> sweeps, const TimeSpan& span,
                                         const Pose2& velocity_from_sonar, const HeadingSource& heading,
                                         VelocitySource& velocity);

}  // namespace pingvox
