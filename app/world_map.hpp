#pragma once

#include <Eigen/Geometry>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sim/world.hpp"

namespace pingvox::app {

/// The ground truth map of a world: cells that a surface passes through are occupied, cells reachable from `inside_m`
/// through faces of other cells are free, the rest unknown. A surface on the face between two cells belongs to the
/// upper one, as in Lattice::key_of.
/// @param water_m   cells outside of this box stay unknown
/// @return kBadOption when there would be more than 2^28 cells in it, or it reaches out of the lattice
Result<OccupancyMap> world_map(const World& world, const Eigen::AlignedBox3d& water_m, const Eigen::Vector3d& inside_m,
                               double resolution_m);

}  // namespace pingvox::app
