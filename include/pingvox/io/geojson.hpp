#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <ostream>
#include <string>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Properties of a path besides its poses.
struct GeoJsonOptions {
  Eigen::Vector3d origin_fix = Eigen::Vector3d::Zero();  ///< where 0, 0 is, as NavQuantity::kFix has it
  std::string name = {};                                 ///< of the path
  NavClock clock = NavClock::kUnknown;                   ///< of its times; kUnix: dates are written, too
  bool has_attitude = true;                              ///< whether the poses have a heading
  /// The positions that it was made of, on the same clock: they have the standard deviations. nullptr: unknown.
  const NavSource* positions = nullptr;
};

/// Writes a path as GeoJSON (RFC 7946), in longitude and latitude of WGS 84 by fix_of_position: a LineString for each
/// part without a gap, and a Point for each pose with its time, its place in metres, its heading and how uncertain its
/// place is. x must be east and y north.
/// @return the number of points; kIo when `out` fails
Result<std::size_t> write_geojson(const Trajectory& map_from_body, const GeoJsonOptions& options, std::ostream& out);

}  // namespace pingvox
