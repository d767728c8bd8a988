#include "io/xyz.hpp"

#include <fmt/core.h>

#include "io/occupied_leaves.hpp"

namespace pingvox {

Result<void> write_xyz(const OccupancyMap& map, std::ostream& out) {
  ByteWriter writer(out);
  for_each_occupied(map, [&](const auto& leaf) {
    const Eigen::Vector3f centre_m = map.lattice().centre_of(leaf.key, leaf.depth).template cast<float>();
    writer.put(fmt::format("{} {} {} {} {}\n", centre_m.x(), centre_m.y(), centre_m.z(), leaf.belief.value(),
                           static_cast<float>(map.lattice().cell_size_m(leaf.depth))));
  });
  return writer.finish();
}

}  // namespace pingvox
