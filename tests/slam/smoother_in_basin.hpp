#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pingvox/slam/slam_smoother.hpp"
#include "slam/basin.hpp"

// The smoother on the drive in a basin.
namespace pingvox::test {

inline SlamSmoother smoother_of(const Basin& basin, SlamOptions options) {
  options.body_from_sonar = pose_from_rpy(Eigen::Vector3d::Zero(), 0.0, 0.0, basin.sonar_yaw_rad);
  return SlamSmoother(std::move(options));
}

inline void add(SlamSmoother& smoother, const std::vector<NavSource>& sources) {
  for (const NavSource& source : sources) {
    for (const NavSample& sample : source.samples) {
      ASSERT_TRUE(smoother.add(source.name, source.quantity, sample));
    }
  }
}

inline Result<SlamSolution> solve(const Basin& basin, const SlamOptions& options, std::uint64_t noise_seed = 1) {
  SlamSmoother smoother = smoother_of(basin, options);
  add(smoother, basin.sources(noise_seed));
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  return smoother.solve();
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

inline Result<SlamSolution> solve_without_velocity(const Basin& basin, SlamOptions options, const NavSource& turning) {
  options.seed = 3;
  SlamSmoother smoother = smoother_of(basin, std::move(options));
  add(smoother, {turning});
  for (const Beam& beam : basin.beams()) smoother.add(beam);
  return smoother.solve();
}

}  // namespace pingvox::test
