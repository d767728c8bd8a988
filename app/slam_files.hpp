#pragma once

#include <string>

#include "commands.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_smoother.hpp"

namespace pingvox::app {

/// Writes the trajectory, and the map if one is asked for.
Result<void> write_slam_results(const Trajectory& trajectory, const OccupancyMap& map, MapAxes axes,
                                const SlamCommand& command);
/// Writes the covariances of the poses as CSV (docs/formats.md).
Result<void> write_covariances(const SlamSolution& solution, const std::string& path);

}  // namespace pingvox::app
