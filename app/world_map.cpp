#include "world_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/internal/triangle_cells.hpp"

namespace pingvox::app {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kMaxCells = std::int64_t{1} << 28;
constexpr int kBrick = 4;  ///< edge [cells] of a brick, which the map stores as one leaf when uniform

/// The cells of a box: empty, water or surface.
class Grid {
 public:
  enum class Kind : std::uint8_t { kUnknown, kWater, kSurface };

  Grid(Cell low, Cell size, double resolution_m)
      : low_(std::move(low)),
        size_(std::move(size)),
        resolution_m_(resolution_m),
        kinds_(static_cast<std::size_t>(size_.prod())) {}

  Kind& at(const Cell& c) { return kinds_[static_cast<std::size_t>(c.x() + size_.x() * (c.y() + size_.y() * c.z()))]; }

  void draw(const Triangle& triangle) {
    for_each_cell_of(triangle, resolution_m_, {low_, low_ + size_ - Cell::Ones()},
                     [this](const Cell& cell) { at(cell - low_) = Kind::kSurface; });
  }

  /// Flood-fills water from a cell through faces, within the cells from `first` to `last`.
  /// REQUIRES a range of cells of the grid.
  void flood(const Cell& from, const Cell& first, const Cell& last) {
    const auto is_open = [&](const Cell& c) {
      return (c.array() >= first.array()).all() && (c.array() <= last.array()).all() && at(c) == Kind::kUnknown;
    };
    std::vector<Cell> waiting = {from};
    while (!waiting.empty()) {
      Cell cell = waiting.back();
      waiting.pop_back();
      if (!is_open(cell)) continue;
      // Fills a whole row, then continues from each open run of the neighbouring rows.
      while (is_open(cell - Cell::UnitX())) --cell.x();
      std::array<bool, 4> is_stretch{};
      for (; is_open(cell); ++cell.x()) {
        at(cell) = Kind::kWater;
        const std::array<Cell, 4> beside = {cell - Cell::UnitY(), cell + Cell::UnitY(), cell - Cell::UnitZ(),
                                            cell + Cell::UnitZ()};
        for (std::size_t side = 0; side < beside.size(); ++side) {
          const bool is_now = is_open(beside[side]);
          if (is_now && !is_stretch[side]) waiting.push_back(beside[side]);
          is_stretch[side] = is_now;
        }
      }
    }
  }

 private:
  Cell low_, size_;
  double resolution_m_;
  std::vector<Kind> kinds_;
};

}  // namespace

Result<OccupancyMap> world_map(const World& world, const Eigen::AlignedBox3d& water_m, const Vector3d& inside_m,
                               double resolution_m) {
  OccupancyMap map(MapOptions{.resolution_m = resolution_m});
  // Whole bricks, with room for surfaces on the border.
  const Vector3d first = ((water_m.min() / resolution_m).array() - 1.0).floor() / kBrick;
  const Vector3d last = ((water_m.max() / resolution_m).array() + 1.0).floor() / kBrick;
  const double cells = ((last - first).array() * kBrick + 2.0 * kBrick).prod();
  if (!(cells <= static_cast<double>(kMaxCells))) {
    return fail(Error::Code::kBadOption,
                fmt::format("the world's map would have {:.3g} cells, more than {}: a coarser --resolution than {} m "
                            "makes fewer",
                            cells, kMaxCells, resolution_m));
  }
  const Cell low = first.array().floor().cast<std::int64_t>() * kBrick;
  const Cell size = ((last.array().floor() - first.array().floor()).cast<std::int64_t>() + 1) * kBrick;
  const Lattice& lattice = map.lattice();
  const auto centre_of = [&](const Cell& c) -> Vector3d {
    return ((low + c).cast<double>().array() + 0.5) * resolution_m;
  };
  if (!lattice.key_of(centre_of(Cell::Zero())) || !lattice.key_of(centre_of(size - Cell::Ones()))) {
    return fail(
        Error::Code::kBadOption,
        fmt::format("the world reaches out of a map with cells of {} m: use a coarser --resolution", resolution_m));
  }

  Grid grid(low, size, resolution_m);
  const TriangleMesh mesh = world.mesh(0.1 * resolution_m);
  for (const auto& [a, b, c] : mesh.triangles) {
    grid.draw({mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]});
  }
  // Cells with their centre in the box: a cell that barely reaches into it is no way around a wall.
  const auto cell_of = [&](const Vector3d& cells_from_zero) -> Cell {
    return cells_from_zero.array().floor().cast<std::int64_t>().matrix() - low;
  };
  const Vector3d half = Vector3d::Constant(0.5);
  grid.flood(cell_of(inside_m / resolution_m), cell_of(water_m.min() / resolution_m + half),
             cell_of(water_m.max() / resolution_m - half));

  Editor editor = map.edit();
  const auto belief_of = [&](Grid::Kind kind) {
    return kind == Grid::Kind::kSurface ? map.options().clamp.highest : map.options().clamp.lowest;
  };
  const Cell bricks = size / kBrick;
  for (std::int64_t n = 0; n < bricks.prod(); ++n) {
    const Cell brick(n % bricks.x(), n / bricks.x() % bricks.y(), n / bricks.x() / bricks.y());
    const Cell corner = brick * kBrick;
    bool is_uniform = true;
    const auto for_each_cell = [&](const auto& visit) {
      for (std::int64_t i = 0; i < kBrick * kBrick * kBrick; ++i) {
        visit(Cell(corner + Cell(i % kBrick, i / kBrick % kBrick, i / kBrick / kBrick)));
      }
    };
    const Grid::Kind kind = grid.at(corner);
    for_each_cell([&](const Cell& cell) { is_uniform = is_uniform && grid.at(cell) == kind; });
    if (is_uniform) {
      if (kind == Grid::Kind::kUnknown) continue;
      editor.set(*lattice.key_of(centre_of(corner)), lattice.depth() - 2, belief_of(kind));
      continue;
    }
    for_each_cell([&](const Cell& cell) {
      if (grid.at(cell) == Grid::Kind::kUnknown) return;
      editor.set(*lattice.key_of(centre_of(cell)), lattice.depth(), belief_of(grid.at(cell)));
    });
  }
  editor.synchronize();
  return map;
}

}  // namespace pingvox::app
