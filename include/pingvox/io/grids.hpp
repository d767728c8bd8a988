#pragma once

#include <ostream>
#include <string_view>

#include "pingvox/analysis/slice.hpp"
#include "pingvox/result.hpp"

// Raster formats of other programs (docs/formats.md).
namespace pingvox {

/// Writes a slice as the image of ROS's map_server: PGM, occupied 0, free 254, unknown 205, the highest y first.
/// @return kIo when `out` fails
Result<void> write_grid_pgm(const Raster<Occupancy>& slice, std::ostream& out);

/// Writes map_server's YAML file for that image.
/// @param image  path of the image relative to this file
/// @return kIo when `out` fails
Result<void> write_grid_yaml(const Raster<Occupancy>& slice, std::string_view image, std::ostream& out);

/// Writes heights as an ESRI ASCII grid, the highest y first; NaN becomes NODATA_value.
/// @return kIo when `out` fails
Result<void> write_heights_asc(const Raster<float>& heights, std::ostream& out);

}  // namespace pingvox
