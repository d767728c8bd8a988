#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "pingvox/geometry/raster.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Layers of cells: those that overlap the range of heights by more than a face, and at least the one that holds the
/// lower end.
struct SliceOptions {
  std::optional<double> min_z_m, max_z_m;  ///< map frame [m]; nullopt: all that is known

  Result<void> validate() const;  ///< kBadOption when one is not finite, or min_z_m > max_z_m
};

// Rasters of maps have one value for each column of cells of the finest resolution, around all columns in which
// anything is known.

/// The largest raster.
inline constexpr std::size_t kMaxRasterCells = std::size_t{1} << 28;

/// A column of the slice is occupied when any of its cells is, free when at least one is and none is occupied, else
/// unknown: where nothing was observed, or nothing that the map's thresholds decide.
/// @return kUnsupported when nothing is known there; kLimit beyond kMaxRasterCells
Result<Raster<Occupancy>> slice_of(const OccupancyMap& map, const SliceOptions& options);

enum class Surface {
  kHighest,  ///< what is seen from above: a bottom
  kLowest,
};

/// Where the highest (lowest) occupied cell of each column of the slice has its upper face [m, map frame]; NaN in a
/// column without one. The raster is that of `slice_of`.
/// @return kUnsupported when nothing is occupied there; kLimit beyond a quarter of kMaxRasterCells
Result<Raster<float>> heights_of(const OccupancyMap& map, const SliceOptions& options, Surface surface);

/// @return kUnsupported when nothing is known in a slice
Result<void> check_slice(const OccupancyMap& map, const SliceOptions& options);

/// The cells of a slice as a map with the same options; cells of other layers are unknown.
/// @return kUnsupported when nothing is known there; kLimit when leaves that the slice cuts have more than
///         kMaxRasterCells columns of cells
Result<OccupancyMap> map_of_slice(const OccupancyMap& map, const SliceOptions& options);

}  // namespace pingvox
