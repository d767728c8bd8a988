#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "pingvox/io/bytes.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Header of a .bt or .ot file.
struct OctomapHeader {
  std::string id;             ///< class of the tree
  std::uint64_t nodes = 0;    ///< number, including the root
  double resolution_m = 0.0;  ///< not checked
  std::size_t tree_at = 0;    ///< first byte of the tree
};

inline constexpr std::string_view kBtFirstLine = "# Octomap OcTree binary file";
inline constexpr std::string_view kOtFirstLine = "# Octomap OcTree file";

/// Reads the text header as leniently as liboctomap: words in any order, comments and unknown words skipped.
/// @return kCorrupt when the first line differs, or `id`, `size`, `res` or `data` is missing or invalid
Result<OctomapHeader> read_octomap_header(const FileBytes& file, std::string_view first_line);

/// Text of the header, equal to liboctomap's unless the resolution needs more than six digits.
/// @param axes  of those that are east and north a comment says so
std::string octomap_header(std::string_view first_line, std::uint64_t nodes, double resolution_m, MapAxes axes);
/// What a comment in the header says of the axes.
MapAxes octomap_axes(const FileBytes& file);

/// An empty map of this resolution. kCorrupt when it is invalid.
Result<OccupancyMap> empty_octomap(const FileBytes& file, double resolution_m, std::size_t memory_limit_bytes);

}  // namespace pingvox
