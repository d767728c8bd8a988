#pragma once

#include "pingvox/geometry/mesh.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A mesh as a map: each cell that a triangle passes through is occupied (as sure as the clamp allows), and nothing is
/// known of the others, inside or out.
/// @return kBadOption when the options do not validate; kLimit when the surface is out of proportion to the cells (more
///         than some 2^26 of them) or reaches out of the lattice
Result<OccupancyMap> surface_map(const TriangleMesh& mesh, const MapOptions& options);

}  // namespace pingvox
