#pragma once

#include <cstddef>
#include <ostream>
#include <string>

#include "pingvox/io/bytes.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A map with the metadata of its file.
struct MapFile {
  Format format = Format::kPvx;
  OccupancyMap map;
  std::string made_by;  ///< kPvx: free text about how the map was made; else empty
  MapAxes axes = MapAxes::kUnknown;
};

/// Reads a map; the format is recognised by content. kCorrupt names the place and the reason.
/// @param memory_limit_bytes  0: none; else kLimit when the tree would exceed it
Result<MapFile> read_map(const FileBytes& file, std::size_t memory_limit_bytes = 0);

/// Writes a map in any format of maps and clouds. kUnsupported when the format cannot hold it (.bt and .ot: depth 16
/// only); the message names one that can.
/// @param axes  kept in .bt, .ot and .pvx if they are east and north
Result<void> write_map(const OccupancyMap& map, Format format, std::string_view made_by, std::ostream& out,
                       MapAxes axes = MapAxes::kUnknown);

/// Writes a map to a file, or to standard output for "-"; errors name the file.
Result<void> write_map(const OccupancyMap& map, Format format, std::string_view made_by, const std::string& path,
                       MapAxes axes = MapAxes::kUnknown);

/// The same in the format that the suffix names: `write_map(map, "harbour.bt")`.
/// @return kUnsupported when the suffix is not of a map or cloud
Result<void> write_map(const OccupancyMap& map, const std::string& path, std::string_view made_by = {});

}  // namespace pingvox
