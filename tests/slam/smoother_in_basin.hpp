#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pingvox/slam/causal_replay.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "slam/basin.hpp"

// The smoother, or what CausalReplay makes of it, on the drive in a basin.
namespace pingvox::test {

template <class Slam = SlamSmoother>
Slam smoother_of(const Basin& basin, SlamOptions options) {
  options.body_from_sonar = pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, basin.sonar_yaw_rad);
  return Slam(std::move(options));
}

template <class Slam>
void add(Slam& smoother, const std::vector<NavSource>& sources) {
  for (const NavSource& source : sources) {
    for (const NavSample& sample : source.samples) {
      ASSERT_TRUE(smoother.add(source.name, source.quantity, sample));
    }
  }
}

template <class Slam = SlamSmoother>
Result<SlamSolution> solve(const Basin& basin, const SlamOptions& options, const std::vector<NavSource>& sources) {
  Slam smoother = smoother_of<Slam>(basin, options);
  add(smoother, sources);
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  return smoother.solve();
}

template <class Slam = SlamSmoother>
Result<SlamSolution> solve(const Basin& basin, const SlamOptions& options, std::uint64_t noise_seed = 1) {
  return solve<Slam>(basin, options, basin.sources(noise_seed));
}

/// As if the clock of the navigation jumped ahead by an hour after 100 s.
inline std::vector<NavSource> with_jump_of_the_clock(std::vector<NavSource> sources) {
  for (NavSource& source : sources) {
    for (NavSample& sample : source.samples) sample.time_s += sample.time_s > 100.0 ? 3600.0 : 0.0;
  }
  return sources;
}

inline std::vector<NavSource> with_velocity_ahead(double velocity_m_s, std::vector<NavSource> sources) {
  for (NavSample& sample : sources[0].samples) sample.value.x() = velocity_m_s;
  return sources;
}

/// Root of the mean square distance from the truth, both beginning at the same pose.
inline double error_m(const Trajectory& trajectory) {
  const auto start = Basin::at(trajectory.poses().front().time_s);
  double sum = 0.0;
  for (const StampedPose& pose : trajectory.poses()) {
    const Eigen::Vector2d moved = Basin::at(pose.time_s).place - start.place;
    sum += (pose.map_from_body.translation().head<2>() - moved).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(trajectory.poses().size()));
}

template <class Slam = SlamSmoother>
Result<SlamSolution> solve_without_velocity(const Basin& basin, SlamOptions options, const NavSource& turning) {
  options.seed = 3;
  return solve<Slam>(basin, options, {turning});
}

}  // namespace pingvox::test
