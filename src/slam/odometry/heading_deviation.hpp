#pragma once

#include <cmath>

#include "pingvox/slam/slam_calibration.hpp"

namespace pingvox {

/// Yaw of the body [rad], without jumps, of which a source with this calibration says `heading_rad`. REQUIRES a valid
/// calibration.
inline double yaw_of_heading(const HeadingCalibration& of, double heading_rad) {
  // Each step leaves nine tenths of the error, or less: the limit of a valid deviation.
  constexpr int kMaxSteps = 300;
  double yaw_rad = heading_rad;
  for (int i = 0; i < kMaxSteps; ++i) {
    const double next_rad = heading_rad - of.constant_rad.value - of.sin1_rad.value * std::sin(yaw_rad) -
                            of.cos1_rad.value * std::cos(yaw_rad) - of.sin2_rad.value * std::sin(2.0 * yaw_rad) -
                            of.cos2_rad.value * std::cos(2.0 * yaw_rad);
    const double moved_rad = std::abs(next_rad - yaw_rad);
    yaw_rad = next_rad;
    if (moved_rad < 1e-12) break;
  }
  return yaw_rad;
}

}  // namespace pingvox
