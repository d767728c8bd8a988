#include "io/ply.hpp"

#include <fmt/core.h>

#include "io/occupied_leaves.hpp"

namespace pingvox {

Result<void> write_ply(const OccupancyMap& map, std::ostream& out) {
  ByteWriter writer(out);
  writer.put(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment occupied leaves of a map with cells of {} m\n"
                  "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float log_odds\n"
                  "property float size\nend_header\n",
                  map.lattice().resolution_m(), occupied_leaves(map)));
  put_occupied(map, writer);
  return writer.finish();
}

}  // namespace pingvox
