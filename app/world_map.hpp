#pragma once

#include <Eigen/Geometry>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sim/world.hpp"

namespace pingvox::app {

/// A world as the map that a perfect sonar would make of it: each cell that a surface passes through is occupied, each
/// that can be reached from `inside_m` through the faces of cells without crossing an occupied one is free, and nothing
/// is known of the others. Where a surface lies in the face between two cells, the upper one is occupied, as
/// Lattice::key_of has it.
/// @param water_m   cells outside of this box stay unknown
/// @return kBadOption when there would be more than 2^28 cells in it, or it reaches out of the lattice
Result<OccupancyMap> world_map(const World& world, const Eigen::AlignedBox3d& water_m, const Eigen::Vector3d& inside_m,
                               double resolution_m);

}  // namespace pingvox::app
