#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "slam/basin.hpp"
#include "slam/smoother/slam_solver.hpp"
#include "slam/sweeps/echo_runs.hpp"

// What is heard and measured in the basin, as the estimation of motion takes it.
namespace pingvox::test {

inline std::vector<SweepEchoes> sweeps_of(const Basin& basin) {
  std::vector<SweepEchoes> sweeps;
  SweepAssembler assembler;
  const auto add = [&](const Sweep& sweep) {
    sweeps.push_back(
        {sweep.extent, sweep.beams.front().time_s, sweep.beams.back().time_s, echo_runs(sweep, {}, EchoOptions())});
  };
  for (Beam& beam : basin.beams()) {
    if (const auto sweep = assembler.add(std::move(beam))) add(*sweep);
  }
  if (const auto sweep = assembler.finish()) add(*sweep);
  return sweeps;
}

inline HeadingSource heading_of(const Basin& basin) {
  std::optional<HeadingSource> heading = heading_source(basin.sources()[1], Pose::Identity());
  return *std::move(heading);
}

inline Pose2 mount_of(const Basin& basin) {
  return {Eigen::Vector2d::Zero(), basin.sonar_yaw_rad};
}

/// Velocity of the vehicle along its yaw and to port.
inline Eigen::Vector2d body_velocity_at(double time_s) {
  const double yaw_rad = Basin::at(time_s).yaw_rad;
  return rotation2(-yaw_rad) * Basin::velocity_at(time_s);
}

}  // namespace pingvox::test
