#include "pingvox/analysis/surface_map.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geometry/internal/triangle_cells.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

constexpr double kMaxSurfaceCells = 0x1p26;

/// Cells that the triangles pass through, roughly and rather more: those of the area, of the edges, of the corners.
double cells_about(const TriangleMesh& mesh, double cell_m) {
  double cells = 0.0;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Vector3d ab = (mesh.vertices_m[ib] - mesh.vertices_m[ia]) / cell_m;
    const Vector3d ac = (mesh.vertices_m[ic] - mesh.vertices_m[ia]) / cell_m;
    cells += 0.5 * ab.cross(ac).norm() + ab.norm() + ac.norm();
  }
  return cells;
}

}  // namespace

Result<OccupancyMap> surface_map(const TriangleMesh& mesh, const MapOptions& options) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  OccupancyMap map(options);
  const Lattice& lattice = map.lattice();
  const double cell_m = lattice.resolution_m();
  for (const Vector3d& vertex_m : mesh.vertices_m) {
    // Of the deepest lattices, too, only as much as 64 bits can number.
    const bool is_near = (vertex_m / cell_m).cwiseAbs().maxCoeff() < 0x1p60;
    if (is_near && lattice.key_of<WideWord>(vertex_m)) continue;
    return fail(Error::Code::kLimit,
                fmt::format("a corner at {:g}, {:g}, {:g} m is outside of a map of {} levels with cells of {} m",
                            vertex_m.x(), vertex_m.y(), vertex_m.z(), lattice.depth(), cell_m));
  }
  if (const double cells = cells_about(mesh, cell_m); !(cells <= kMaxSurfaceCells)) {
    return fail(
        Error::Code::kLimit,
        fmt::format("its surface would be about {:.2g} cells of {} m, more than {:.2g}: are its lengths metres?", cells,
                    cell_m, kMaxSurfaceCells));
  }
  const std::int64_t half = std::int64_t{1} << std::min(lattice.depth() - 1, 61);
  const CellRange all{Cell::Constant(-half), Cell::Constant(half - 1)};
  {
    Editor editor = map.edit();
    for (const auto& [a, b, c] : mesh.triangles) {
      const Triangle triangle = {mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]};
      for_each_cell_of(triangle, cell_m, all, [&](const Cell& cell) {
        const auto key = lattice.key_of<WideWord>((cell.cast<double>().array() + 0.5).matrix() * cell_m);
        if (key) editor.set(*key, lattice.depth(), options.clamp.highest);
      });
    }
  }
  return map;
}

}  // namespace pingvox
