#pragma once

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/distance_field.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "slam/smoother/slam_input.hpp"

namespace pingvox {

/// See SlamSmoother::solve_in. `log` is that of the recording, on the clock of the beams.
Result<MapSolution> solve_in_map(SlamInput input, const NavLog& log, const SlamOptions& options,
                                 const DistanceField& map, const Trajectory& near);

}  // namespace pingvox
