#pragma once

#include <span>
#include <vector>

#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "slam/sweeps/echo_runs.hpp"

namespace pingvox {

/// The echoes of a sweep that ended.
struct SweepEchoes {
  Sweep::Extent extent;
  double from_s, to_s;
  std::vector<EchoRun> runs;
};

/// The echoes of a sweep, by the options; bearings run counter-clockwise, seen from above the vehicle.
SweepEchoes sweep_echoes(const Sweep& sweep, const SlamOptions& options);

/// Usual time of a sweep: of complete ones, where there are any. REQUIRES a sweep.
double sweep_duration_s(std::span<const SweepEchoes> sweeps);

/// The range that nine of ten echoes are within; 0 without echoes.
double reach_of(std::span<const SweepEchoes> sweeps);

}  // namespace pingvox
