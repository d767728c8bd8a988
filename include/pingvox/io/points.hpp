#pragma once

#include <cstddef>
#include <ostream>

#include "pingvox/io/format.hpp"
#include "pingvox/map/point_scan.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Writes the points of all scans, in the map frame [m], as a cloud: .ply and .pcd (binary, x, y, z as floats) or .xyz.
/// Needs memory for all of them.
/// @return the number of points; the source's error; kUnsupported for other formats; kIo when `out` fails
Result<std::size_t> write_points(ScanSource& scans, Format format, std::ostream& out);

}  // namespace pingvox
