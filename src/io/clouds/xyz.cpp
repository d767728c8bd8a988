#include "io/clouds/xyz.hpp"

#include <fmt/core.h>

#include "io/maps/occupied_leaves.hpp"

namespace pingvox {

Result<void> write_xyz(const OccupancyMap& map, std::ostream& out) {
  ByteWriter writer(out);
  const Coordinates coordinates = coordinates_of(map);
  for_each_occupied(map, [&](const Leaf& leaf) {
    writer.put(fmt::format("{} {} {}\n", text_of(leaf.centre_m(), coordinates), leaf.belief.value(),
                           static_cast<float>(leaf.edge_m())));
  });
  return writer.finish();
}

}  // namespace pingvox
