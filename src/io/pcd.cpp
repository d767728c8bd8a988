#include "io/pcd.hpp"

#include <fmt/core.h>

#include "io/occupied_leaves.hpp"

namespace pingvox {

Result<void> write_pcd(const OccupancyMap& map, std::ostream& out) {
  ByteWriter writer(out);
  const std::uint64_t points = occupied_leaves(map);
  writer.put(
      fmt::format("# .PCD v0.7 - Point Cloud Data file format\n# occupied leaves of a map with cells of {} m\n"
                  "VERSION 0.7\nFIELDS x y z log_odds size\nSIZE 4 4 4 4 4\nTYPE F F F F F\nCOUNT 1 1 1 1 1\n"
                  "WIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
                  map.lattice().resolution_m(), points, points));
  put_occupied(map, writer);
  return writer.finish();
}

}  // namespace pingvox
