#include "io/clouds/pcd.hpp"

#include <fmt/core.h>

#include <string>

#include "io/maps/occupied_leaves.hpp"

namespace pingvox {

std::string pcd_header(std::string_view comment, std::uint64_t points, Coordinates coordinates,
                       std::initializer_list<std::string_view> others) {
  const char size = coordinates == Coordinates::kFloat ? '4' : '8';
  std::string names = "x y z", sizes = fmt::format("{0} {0} {0}", size), types = "F F F", counts = "1 1 1";
  for (const std::string_view name : others) {
    names += fmt::format(" {}", name);
    sizes += " 4";
    types += " F";
    counts += " 1";
  }
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\n# {}\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\n"
      "WIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
      comment, names, sizes, types, counts, points, points);
}

Result<void> write_pcd(const OccupancyMap& map, std::ostream& out) {
  ByteWriter writer(out);
  writer.put(pcd_header(fmt::format("occupied leaves of a map with cells of {} m", map.lattice().resolution_m()),
                        occupied_leaves(map), coordinates_of(map), {"log_odds", "size"}));
  put_occupied(map, writer);
  return writer.finish();
}

}  // namespace pingvox
