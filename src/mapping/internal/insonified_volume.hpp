#pragma once

#include "pingvox/geometry/lattice.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox {

/// Volume of a beam up to its echo: a wedge of `width` and `height` about its axis, on the sphere.
struct InsonifiedVolume {
  Pose map_from_sensor = Pose::Identity();
  double bearing_rad = 0.0;
  double width_rad = 0.0;   ///< horizontal, full angle; 0 is a plane
  double height_rad = 0.0;  ///< vertical, full angle; 0 is a fan
  double range_m = 0.0;     ///< > 0
};

/// Marks the cells that the volume touches as missed. By geometry, row by row of cells, instead of by rays: it marks
/// each cell that a ray inside of the volume would, and none farther from the volume than half a cell's diagonal.
/// @return false, and nothing is marked, when the volume's box reaches out of the lattice
/// REQUIRES 0 <= width_rad <= pi, 0 <= height_rad < pi
bool trace_volume(const InsonifiedVolume& volume, ScanUpdate& scan);

}  // namespace pingvox
