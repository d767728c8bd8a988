#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mapping/internal/beam_tracer.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {

using BeamSweep = std::vector<PlacedBeam>;

/// The first `most` sweeps of the tank: free up to each echo's range, as in a scan of rays.
std::vector<BeamSweep> beam_sweeps(const TankEchoes& tank, std::size_t most);

/// Traces and applies each sweep, as `pingvox map` does after detection. `scan` is reused buffer space, empty before
/// and after.
void insert(OccupancyMap& map, ScanUpdate& scan, std::span<const BeamSweep> sweeps, const BeamModelOptions& model);

}  // namespace pingvox::bench
