#pragma once

#include <functional>
#include <optional>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/point_scan.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Called after each scan with the report so far, to show the progress.
using Progress = std::function<void(const BuildReport&)>;

/// Maps all beams of a source by a BeamMapper. A beam whose only echo is beyond echo.max_range_m frees cells up to
/// there.
/// @param map_from_body  where the vehicle was; beams outside of its time are left out and counted
/// @return kBadOption when the options do not validate, the source's error when it fails, kLimit when the map would
///         grow too large, kNoMemory when memory ran out. The map keeps the beams before.
Result<BuildReport> build_map(BeamSource& source, const Trajectory& map_from_body, const BuildOptions& options,
                              OccupancyMap& map, const Progress& progress = {});

/// The same for scans of end points: of the options count `miss`, `threads`, the model's `ray` and `hit`, the echo's
/// `max_range_m` and, for scans with a time, `body_from_sensor`.
/// @param map_from_body  where the vehicle was; scans with another time are left out. Others are in the map frame.
/// @return the same; kLimit also for a ray that is too long (check_rays)
Result<BuildReport> build_map(ScanSource& source, const Trajectory& map_from_body, const BuildOptions& options,
                              OccupancyMap& map, const Progress& progress = {});

}  // namespace pingvox
