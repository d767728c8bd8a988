#pragma once

#include <Eigen/Core>

#include "pingvox/geometry/lattice.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox {

enum class RayAlgorithm { kDda, kBresenham };

/// Maximum length of a ray in cells for whoever maps what a file says: such a ray needs some hundred megabytes. A map
/// of 16 levels is 65,536 cells wide.
inline constexpr double kMaxCellsInRay = 1e6;

/// Marks the cells from `from_m` to `to_m` [m, map frame] as missed, the end cell excluded: what `dda` or `bresenham`
/// walk over.
/// @return false, and nothing is marked, when an end lies outside of the lattice
bool trace_ray(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, RayAlgorithm algorithm, ScanUpdate& scan);

}  // namespace pingvox
