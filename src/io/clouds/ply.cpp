#include "io/clouds/ply.hpp"

#include <fmt/core.h>

#include "io/maps/occupied_leaves.hpp"

namespace pingvox {

std::string ply_header(std::string_view comment, std::uint64_t points, Coordinates coordinates,
                       std::initializer_list<std::string_view> others) {
  std::string text =
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n", comment, points);
  for (const char axis : {'x', 'y', 'z'}) {
    text += fmt::format("property {} {}\n", coordinates == Coordinates::kFloat ? "float" : "double", axis);
  }
  for (const std::string_view field : others) text += fmt::format("property float {}\n", field);
  return text + "end_header\n";
}

Result<void> write_ply(const OccupancyMap& map, std::ostream& out) {
  ByteWriter writer(out);
  writer.put(ply_header(fmt::format("occupied leaves of a map with cells of {} m", map.lattice().resolution_m()),
                        occupied_leaves(map), coordinates_of(map), {"log_odds", "size"}));
  put_occupied(map, writer);
  return writer.finish();
}

}  // namespace pingvox
