#pragma once

#include <cstddef>
#include <ostream>
#include <string_view>

#include "pingvox/io/bytes.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Reads our own format: a map of any depth with log-odds and options. kUnsupported: written by a later version;
/// kCorrupt: any damage.
Result<MapFile> read_pvx(const FileBytes& file, std::size_t memory_limit_bytes);

Result<void> write_pvx(const OccupancyMap& map, std::string_view made_by, MapAxes axes, std::ostream& out);

}  // namespace pingvox
