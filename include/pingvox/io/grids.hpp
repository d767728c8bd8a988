#pragma once

#include <Eigen/Core>
#include <optional>
#include <ostream>
#include <string_view>

#include "pingvox/analysis/slice.hpp"
#include "pingvox/geometry/raster.hpp"
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

/// A slice as numbers: 1 occupied, 0 free, NaN unknown.
Raster<float> occupancy_numbers(const Raster<Occupancy>& slice);

/// Writes a raster as an ESRI ASCII grid, the highest y first; NaN becomes NODATA_value.
/// @return kIo when `out` fails
Result<void> write_heights_asc(const Raster<float>& heights, std::ostream& out);

/// Writes the file beside such a grid that places it on the earth: metres east and north of a fix, in a transverse
/// Mercator projection of WGS 84.
/// @param origin_fix  where 0, 0 is, as NavQuantity::kFix has it
/// @return kIo when `out` fails
Result<void> write_prj(const Eigen::Vector3d& origin_fix, std::ostream& out);

/// Writes a raster as GeoTIFF: floats, compressed, NaN as the value of no data. With an origin it is in longitude and
/// latitude of WGS 84, by the inverse of position_of_fix, else in metres of the map frame.
/// @param origin_fix  where 0, 0 is, as NavQuantity::kFix has it; nullopt: not known
/// @param what        what the numbers are, ASCII
/// @return kNoMemory; kIo when `out` fails
Result<void> write_geotiff(const Raster<float>& raster, const std::optional<Eigen::Vector3d>& origin_fix,
                           std::string_view what, std::ostream& out);

/// Which axis of the map frame is up in a picture.
enum class PictureUp {
  kY,  ///< x is right: north is up where x is east
  kX,  ///< y is left: ahead of a vehicle that looks along x is up
};

/// Writes the world file of a raster's picture, by which a GIS places it in metres of the map frame.
/// @return kIo when `out` fails
Result<void> write_world_file(const Raster<float>& raster, PictureUp up, std::ostream& out);

}  // namespace pingvox
