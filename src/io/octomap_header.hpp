#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "pingvox/io/bytes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// What stands in front of the tree of a .bt or .ot file.
struct OctomapHeader {
  std::string id;             ///< the class that wrote it
  std::uint64_t nodes = 0;    ///< of all kinds, the root included
  double resolution_m = 0.0;  ///< not checked
  std::size_t tree_at = 0;    ///< first byte of the tree
};

inline constexpr std::string_view kBtFirstLine = "# Octomap OcTree binary file";
inline constexpr std::string_view kOtFirstLine = "# Octomap OcTree file";

/// Reads the text header, as freely as liboctomap does: words in any order, comments and unknown words stepped over.
/// kCorrupt when the first line is another one, or `id`, `size`, `res` or `data` is missing or not what it should be.
Result<OctomapHeader> read_octomap_header(const FileBytes& file, std::string_view first_line);

/// The same text as liboctomap's, save that a resolution for which its six digits are not enough gets all it needs.
std::string octomap_header(std::string_view first_line, std::uint64_t nodes, double resolution_m);

/// An empty map of a header's resolution. kCorrupt when that is no resolution.
Result<OccupancyMap> empty_octomap(const FileBytes& file, double resolution_m, std::size_t memory_limit_bytes);

}  // namespace pingvox
