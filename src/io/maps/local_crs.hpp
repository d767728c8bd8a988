#pragma once

#include <Eigen/Core>
#include <string>

namespace pingvox {

/// Who reads the well-known text: their names of the same things differ.
enum class WktDialect { kOgc, kEsri };

/// A coordinate reference system in metres east and north of a fix, as well-known text, version 1: a transverse
/// Mercator projection of WGS 84 centred on it. Off the axes it differs from position_of_fix, at 45 degrees by x * y /
/// 6400 km.
std::string local_crs_wkt(const Eigen::Vector3d& origin_fix, WktDialect dialect);

}  // namespace pingvox
