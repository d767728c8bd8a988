#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <string>
#include <string_view>

#include "pingvox/io/bytes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

// Shared by the readers and writers of maps.
namespace pingvox {

/// Depth of OctoMap's trees, which is not in their files (docs/formats.md).
inline constexpr int kOctomapDepth = 16;

/// kCorrupt: the file, the place in it, the reason.
tl::unexpected<Error> damage_error(const FileBytes& file, std::size_t byte, std::string_view reason);

/// kLimit: the file, the place in it, the limit [bytes].
tl::unexpected<Error> over_limit(const FileBytes& file, std::size_t byte, std::size_t limit);

/// kUnsupported, naming a suitable format, unless the map has 16 levels.
Result<void> check_octomap_depth(const OccupancyMap& map, std::string_view suffix);

/// Key of a child: `parent` is the lowest cell of a node of `depth` on a lattice of `levels`.
WideKey child_key(const WideKey& parent, int depth, int levels, int octant);

/// Adds leaves to a map.
class LeafBuilder {
 public:
  /// @param memory_limit_bytes  0: none
  LeafBuilder(OccupancyMap& map, const FileBytes& file, std::size_t memory_limit_bytes)
      : map_(map), editor_(map.edit()), file_(file), memory_limit_bytes_(memory_limit_bytes) {}

  /// @param byte  position of the leaf, for messages
  /// @return kCorrupt when the belief is not finite, kLimit when the tree exceeds the limit
  Result<void> add(const WideKey& key, int depth, float belief, std::size_t byte);

 private:
  OccupancyMap& map_;
  Editor editor_;
  const FileBytes& file_;
  std::size_t memory_limit_bytes_;
};

}  // namespace pingvox
