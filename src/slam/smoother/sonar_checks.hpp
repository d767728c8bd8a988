#pragma once

#include <optional>
#include <span>

#include "nav/internal/navigation.hpp"
#include "pingvox/nav/clock_offset.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "slam/internal/picture_turns.hpp"
#include "slam/odometry/sonar_odometry.hpp"
#include "slam/smoother/slam_solver.hpp"

namespace pingvox {

/// Checks of the navigation by the sonar. nullopt: not observable, or echoes are not matched.
struct SonarChecks {
  std::optional<VelocityCheck> velocity;
  std::optional<ClockOffset> clock;  ///< of the heading

  bool contradict_velocity() const { return velocity && velocity->contradicts; }
};

/// @param heading  the main one
/// @param turns    of the same beams as the sweeps
SonarChecks checks_of(const VelocitySource& velocity, const HeadingSource& heading, std::span<const SweepEchoes> sweeps,
                      PictureTurns turns, const SlamOptions& options);

/// REQUIRES a report that names the velocity and the heading.
void report_checks(const SonarChecks& checks, SlamReport& report);

}  // namespace pingvox
