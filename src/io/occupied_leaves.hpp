#pragma once

#include <array>
#include <cstdint>

#include "io/byte_writer.hpp"
#include "pingvox/map/for_each_leaf.hpp"

// Shared by the writers of clouds.
namespace pingvox {

template <class Visitor>
void for_each_occupied(const OccupancyMap& map, Visitor visit) {
  for_each_leaf(map, [&](const Leaf& leaf) {
    if (classify(leaf.belief, map.options().thresholds) == Occupancy::kOccupied) visit(leaf);
  });
}

inline std::uint64_t occupied_leaves(const OccupancyMap& map) {
  std::uint64_t leaves = 0;
  for_each_occupied(map, [&](const Leaf&) { ++leaves; });
  return leaves;
}

/// Five floats for each occupied leaf: x, y, z of its centre, its log-odds, its size.
inline void put_occupied(const OccupancyMap& map, ByteWriter& writer) {
  for_each_occupied(map, [&](const Leaf& leaf) {
    const Eigen::Vector3f centre_m = leaf.centre_m().cast<float>();
    for (const float value : centre_m) writer.put(value);
    writer.put(leaf.belief.value());
    writer.put(static_cast<float>(leaf.edge_m()));
  });
}

}  // namespace pingvox
