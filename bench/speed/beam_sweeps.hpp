#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {

/// A beam and its echo for the beam model: free up to the echo's range, as in a scan of rays.
struct HeardBeam {
  Beam beam;
  Echo echo;
};
using BeamSweep = std::vector<HeardBeam>;

/// The first `most` sweeps of the tank.
std::vector<BeamSweep> beam_sweeps(const TankEchoes& tank, std::size_t most);

/// Traces and applies each sweep, as `pingvox map` does after detection. `scan` is reused buffer space, empty before
/// and after.
void insert(OccupancyMap& map, ScanUpdate& scan, std::span<const BeamSweep> sweeps, const BeamModelOptions& model);

}  // namespace pingvox::bench
