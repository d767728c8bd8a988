#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "pingvox/nav/nav_log.hpp"

/// A vehicle that turns, as a compass sees it.
namespace pingvox::test {

using Yaw = std::function<double(double)>;  ///< [rad] by the time [s]

/// Turns to and fro, never twice the same way [rad].
inline double wander(double time_s) {
  double yaw = 0.0, phase = 0.0;
  for (const double rad_s : {0.031, 0.047, 0.083, 0.127, 0.171, 0.229, 0.293}) {
    yaw += 0.012 / rad_s * std::sin(rad_s * time_s + (phase += 1.7));
  }
  return yaw;
}

/// Samples of an attitude from `from_s` on, whose times are `clock_s` later.
inline NavLog log_of(const Yaw& yaw, double from_s, double to_s, double step_s, double clock_s) {
  NavSource source{"ATTITUDE", NavQuantity::kAttitude, {}};
  for (double time_s = from_s; time_s < to_s; time_s += step_s) {
    NavSample sample;
    sample.time_s = time_s + clock_s;
    sample.value = {0.0, 0.0, std::remainder(yaw(time_s), 2.0 * std::numbers::pi)};
    source.samples.push_back(sample);
  }
  return *NavLog::make({source}, NavClock::kUnknown);
}

}  // namespace pingvox::test
