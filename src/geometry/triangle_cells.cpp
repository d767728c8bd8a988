#include "geometry/internal/triangle_cells.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace pingvox {
namespace {

using Eigen::Vector3d;

/// Whether a triangle and a box have a point in common: no axis keeps them apart (Akenine-Moeller 2001).
bool touches(const Triangle& triangle, const Vector3d& centre, const Vector3d& half) {
  const Triangle t = {triangle[0] - centre, triangle[1] - centre, triangle[2] - centre};
  const auto is_apart = [&](const Vector3d& axis) {
    const auto [low, high] = std::minmax({t[0].dot(axis), t[1].dot(axis), t[2].dot(axis)});
    const double reach = axis.cwiseAbs().dot(half);
    return low > reach || high < -reach;
  };
  const Triangle edges = {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
  if (is_apart(edges[0].cross(edges[1]))) return false;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Vector3d unit = Vector3d::Unit(axis);
    if (is_apart(unit)) return false;
    for (const Vector3d& edge : edges) {
      if (is_apart(unit.cross(edge))) return false;
    }
  }
  return true;
}

/// Halves the range of cells until one is left: most of a large triangle's box is far from it.
void visit_cells(const Triangle& triangle, double cell_m, const CellRange& range,
                 const std::function<void(const Cell&)>& visit) {
  const auto& [first, last] = range;
  if ((first.array() > last.array()).any()) return;
  // A face belongs to the cell above it. So does what rounding puts a hair below it.
  const Vector3d low = first.cast<double>() * cell_m - Vector3d::Constant(1e-9);
  const Vector3d half = 0.5 * cell_m * (last - first + Cell::Ones()).cast<double>();
  if (!touches(triangle, low + half, half - Vector3d::Constant(1e-12))) return;
  Eigen::Index axis = 0;
  const std::int64_t longest = (last - first).maxCoeff(&axis);
  if (longest == 0) {
    visit(first);
    return;
  }
  CellRange below = range, above = range;
  below.last[axis] = first[axis] + longest / 2;
  above.first[axis] = below.last[axis] + 1;
  visit_cells(triangle, cell_m, below, visit);
  visit_cells(triangle, cell_m, above, visit);
}

}  // namespace

void for_each_cell_of(const Triangle& triangle, double cell_m, const CellRange& range,
                      const std::function<void(const Cell&)>& visit) {
  const Vector3d low = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]);
  const Vector3d high = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]);
  // One cell more to each side: `touches` decides.
  const Cell first = (low / cell_m).array().floor().cast<std::int64_t>() - 1;
  const Cell last = (high / cell_m).array().floor().cast<std::int64_t>() + 1;
  visit_cells(triangle, cell_m, {first.cwiseMax(range.first), last.cwiseMin(range.last)}, visit);
}

}  // namespace pingvox
