#pragma once

#include <ostream>
#include <string_view>

#include "pingvox/map/slice.hpp"
#include "pingvox/result.hpp"

// Rasters as other programs read them (docs/formats.md).
namespace pingvox {

/// A slice as the picture of a map for ROS's map_server: PGM, occupied 0, free 254, unknown 205, the highest y first.
/// @return kIo when `out` fails
Result<void> write_grid_pgm(const Raster<Occupancy>& slice, std::ostream& out);

/// What map_server wants to know about that picture.
/// @param image  the picture's name, as seen from this file
/// @return kIo when `out` fails
Result<void> write_grid_yaml(const Raster<Occupancy>& slice, std::string_view image, std::ostream& out);

/// Heights as an ESRI ASCII grid, the highest y first; NaN becomes NODATA_value.
/// @return kIo when `out` fails
Result<void> write_heights_asc(const Raster<float>& heights, std::ostream& out);

}  // namespace pingvox
