#pragma once

#include <array>
#include <cstdint>

#include "io/byte_writer.hpp"
#include "pingvox/map/for_each_leaf.hpp"

// What the writers of clouds share.
namespace pingvox {

template <class Visitor>
void for_each_occupied(const OccupancyMap& map, Visitor visit) {
  with_key_word(map.lattice().depth(), [&]<KeyWord W>() {
    for_each_leaf<W>(map, {}, [&](const Leaf<W>& leaf) {
      if (classify(leaf.belief, map.options().thresholds) == Occupancy::kOccupied) visit(leaf);
    });
  });
}

inline std::uint64_t occupied_leaves(const OccupancyMap& map) {
  std::uint64_t leaves = 0;
  for_each_occupied(map, [&](const auto&) { ++leaves; });
  return leaves;
}

/// Five floats for each occupied leaf: x, y, z of its middle, its log-odds, its edge.
inline void put_occupied(const OccupancyMap& map, ByteWriter& writer) {
  for_each_occupied(map, [&](const auto& leaf) {
    const Eigen::Vector3f centre_m = map.lattice().centre_of(leaf.key, leaf.depth).template cast<float>();
    for (const float value : centre_m) writer.put(value);
    writer.put(leaf.belief.value());
    writer.put(static_cast<float>(map.lattice().cell_size_m(leaf.depth)));
  });
}

}  // namespace pingvox
