#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>

namespace pingvox {

/// The corners of a triangle [m].
using Triangle = std::array<Eigen::Vector3d, 3>;

/// A cell of a grid of cubes, counted from the one whose lowest corner is the origin.
using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

/// All cells between two, which belong to it.
struct CellRange {
  Cell first, last;
};

/// Calls `visit` once for each cell within `range` that a triangle passes through. Where it lies in the face between
/// two cells it is in the upper one, as Lattice::key_of has it.
/// @param cell_m  edge of a cell [m], > 0
/// REQUIRES that the triangle's cells have numbers of 62 bits
void for_each_cell_of(const Triangle& triangle, double cell_m, const CellRange& range,
                      const std::function<void(const Cell&)>& visit);

}  // namespace pingvox
