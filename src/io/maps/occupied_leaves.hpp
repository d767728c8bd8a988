#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "io/bytes/byte_writer.hpp"
#include "io/nav/coordinates.hpp"
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

/// How the centres of a map's leaves are written.
inline Coordinates coordinates_of(const OccupancyMap& map) {
  const std::optional<Box> bounds = map.bounds();
  return coordinates_up_to(bounds ? bounds->min.cwiseAbs().cwiseMax(bounds->max.cwiseAbs()).maxCoeff() : 0.0);
}

/// For each occupied leaf x, y, z of its centre, and as floats its log-odds and its size.
inline void put_occupied(const OccupancyMap& map, ByteWriter& writer) {
  const Coordinates coordinates = coordinates_of(map);
  for_each_occupied(map, [&](const Leaf& leaf) {
    put_point(leaf.centre_m(), coordinates, writer);
    writer.put(leaf.belief.value());
    writer.put(static_cast<float>(leaf.edge_m()));
  });
}

}  // namespace pingvox
