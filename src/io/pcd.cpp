#include "io/pcd.hpp"

#include <fmt/format.h>

#include <vector>

#include "io/occupied_leaves.hpp"

namespace pingvox {

std::string pcd_header(std::string_view comment, std::uint64_t points, std::initializer_list<std::string_view> fields) {
  const auto repeat = [&](std::string_view word) { return std::vector<std::string_view>(fields.size(), word); };
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\n# {}\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\n"
      "WIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
      comment, fmt::join(fields, " "), fmt::join(repeat("4"), " "), fmt::join(repeat("F"), " "),
      fmt::join(repeat("1"), " "), points, points);
}

Result<void> write_pcd(const OccupancyMap& map, std::ostream& out) {
  ByteWriter writer(out);
  writer.put(pcd_header(fmt::format("occupied leaves of a map with cells of {} m", map.lattice().resolution_m()),
                        occupied_leaves(map), {"x", "y", "z", "log_odds", "size"}));
  put_occupied(map, writer);
  return writer.finish();
}

}  // namespace pingvox
