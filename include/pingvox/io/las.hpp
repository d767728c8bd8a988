#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <ostream>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Writes the centres of the occupied leaves as LAS 1.4 [m, map frame], with their probability as intensity, and as
/// extra bytes their probability and their size [m].
/// @param origin_fix  where 0, 0 is (NavQuantity::kFix): names the coordinate reference system; nullopt: not known
/// @return the number of points; kUnsupported when nothing is occupied; kLimit when the coordinates do not fit; kIo
///         when `out` fails
Result<std::size_t> write_las(const OccupancyMap& map, const std::optional<Eigen::Vector3d>& origin_fix,
                              std::ostream& out);

}  // namespace pingvox
