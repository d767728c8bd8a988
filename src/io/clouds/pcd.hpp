#pragma once

#include <cstdint>
#include <initializer_list>
#include <ostream>
#include <string>
#include <string_view>

#include "io/nav/coordinates.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Header of a binary cloud whose points have x, y, z and other fields, each of these a float.
std::string pcd_header(std::string_view comment, std::uint64_t points, Coordinates coordinates,
                       std::initializer_list<std::string_view> others);

/// Writes the occupied leaves of a map as PCD 0.7, binary, with the values of write_ply.
Result<void> write_pcd(const OccupancyMap& map, std::ostream& out);

}  // namespace pingvox
