#pragma once

#include <optional>
#include <string>

#include "commands.hpp"
#include "open_log.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// The trajectory in a file of TUM lines; without one the vehicle stood still at the origin.
Result<Trajectory> trajectory_of(const std::optional<std::string>& poses);

/// Whether the range in which echoes are looked for is one; kBadOption names the options.
Result<void> check_ranges(const BuildOptions& options);

/// Adds a log of either kind to the map. kCorrupt when nothing in it could be mapped.
/// @param name  of the log, for messages
/// @param head  what the call says of it
Result<BuildReport> map_log(const Log& log, const std::string& name, const Trajectory& trajectory,
                            const BuildOptions& options, const HeadWords& head, OccupancyMap& map,
                            const Progress& progress = {});

}  // namespace pingvox::app
