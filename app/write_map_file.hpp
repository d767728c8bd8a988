#pragma once

#include <string>

#include "pingvox/io/format.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// Writes a map to a file, or to standard output for "-". Every message names the file.
Result<void> write_map_file(const std::string& path, const OccupancyMap& map, Format format,
                            const std::string& made_by);

}  // namespace pingvox::app
