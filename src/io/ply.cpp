#include "io/ply.hpp"

#include <fmt/core.h>

#include <cstdint>

#include "io/byte_writer.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

template <class Visitor>
void for_each_occupied(const OccupancyMap& map, Visitor visit) {
  with_key_word(map.lattice().depth(), [&]<KeyWord W>() {
    for_each_leaf<W>(map, {}, [&](const Leaf<W>& leaf) {
      if (classified(leaf.belief, map.options().thresholds) == Occupancy::kOccupied) visit(leaf);
    });
  });
}

}  // namespace

Result<void> write_ply(const OccupancyMap& map, std::ostream& out) {
  std::uint64_t vertices = 0;
  for_each_occupied(map, [&](const auto&) { ++vertices; });
  ByteWriter writer(out);
  writer.put(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment occupied leaves of a map with cells of {} m\n"
                  "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float log_odds\n"
                  "property float size\nend_header\n",
                  map.lattice().resolution_m(), vertices));
  for_each_occupied(map, [&](const auto& leaf) {
    const Eigen::Vector3f centre_m = map.lattice().centre_of(leaf.key, leaf.depth).template cast<float>();
    writer.put(centre_m.x());
    writer.put(centre_m.y());
    writer.put(centre_m.z());
    writer.put(leaf.belief.value());
    writer.put(static_cast<float>(map.lattice().cell_size_m(leaf.depth)));
  });
  return writer.finish();
}

}  // namespace pingvox
