#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {

/// A beam and its echo as the beam model takes them: free up to the echo's range, which is what a scan of rays says.
struct HeardBeam {
  Beam beam;
  Echo echo;
};
using BeamSweep = std::vector<HeardBeam>;

/// The first sweeps of the tank, at most so many.
std::vector<BeamSweep> beam_sweeps(const TankEchoes& tank, std::size_t most);

/// Each sweep traced and applied, as `pingvox map` does once it has found the echoes. `scan` is room that is used for
/// all of them, empty before and after.
void insert(OccupancyMap& map, ScanUpdate& scan, std::span<const BeamSweep> sweeps, const BeamModelOptions& model);

}  // namespace pingvox::bench
