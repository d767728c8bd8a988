#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A trajectory with a gap where two poses are more than five usual steps, and half a second, apart: nobody knows what
/// the vehicle did meanwhile. @see Trajectory::make
/// @param least_gap_s  and as many seconds
inline Result<Trajectory> trajectory_with_gaps(std::vector<StampedPose> poses, double least_gap_s = 0.0) {
  if (poses.empty()) return Trajectory::make({});
  NavSource times;
  for (const StampedPose& pose : poses) times.samples.push_back({.time_s = pose.time_s});
  const double longest_step_s = std::max(summary_of(times).longest_step_s, least_gap_s);
  return Trajectory::make(std::move(poses), longest_step_s);
}

}  // namespace pingvox
