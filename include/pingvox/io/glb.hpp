#pragma once

#include <cstddef>
#include <ostream>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// What the colours of a mesh show.
enum class MeshColours {
  kHeight,       ///< of the cell, between the lowest and the highest occupied one
  kProbability,  ///< that the cell is occupied, between the lowest and the highest of them
};

/// The largest mesh that is written [rectangles].
inline constexpr std::size_t kMaxMeshRectangles = std::size_t{1} << 24;

/// Writes the surface of the occupied cells as binary glTF 2.0: the faces between an occupied cell and one that is not,
/// those in one plane and of one colour joined to rectangles. Lengths are metres; glTF's y is up, so x, y, z of the map
/// frame are x, -z, y there.
/// @return the number of rectangles; kUnsupported when nothing is occupied; kLimit beyond kMaxMeshRectangles;
///         kNoMemory; kIo when `out` fails
Result<std::size_t> write_glb(const OccupancyMap& map, MeshColours colours, std::ostream& out);

}  // namespace pingvox
