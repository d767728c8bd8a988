#include "pingvox/analysis/region_counts.hpp"

#include <cmath>
#include <cstdint>

#include "map/internal/count_cells.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

/// Cells along each axis, counted from the centre of the lattice; `last` is in it. As numbers, since lattices may be
/// deeper than integers.
struct CellBox {
  Eigen::Array3d first, last;

  double cells() const { return (last - first + 1.0).max(0.0).prod(); }
};

CellBox common(const CellBox& a, const CellBox& b) {
  return {a.first.max(b.first), a.last.min(b.last)};
}

std::uint64_t saturated(double cells) {
  constexpr double kLimit = 0x1p64;
  return cells >= kLimit ? UINT64_MAX : static_cast<std::uint64_t>(cells);
}

}  // namespace

RegionCounts counts_in(const OccupancyMap& map, const Box& box) {
  const Lattice& lattice = map.lattice();
  const double half = 0.5 * lattice.cell_size_m(0) * lattice.cells_per_m();
  const CellBox all{Eigen::Array3d::Constant(-half), Eigen::Array3d::Constant(half - 1.0)};
  const CellBox asked = common(
      {(lattice.in_cells(box.min).array() - 0.5).ceil(), (lattice.in_cells(box.max).array() - 0.5).floor()}, all);
  RegionCounts counts;
  counts.cells = saturated(asked.cells());
  if (counts.cells == 0) return counts;
  for_each_leaf(map, {.max_depth = {}, .box = box}, [&](const Leaf& leaf) {
    const double edge = std::round(leaf.edge_m() * lattice.cells_per_m());
    const Eigen::Array3d first = (lattice.in_cells(leaf.centre_m()).array() - 0.5 * edge).round();
    const std::uint64_t cells = saturated(common({first, first + edge - 1.0}, asked).cells());
    detail::count_cells(classify(leaf.belief, map.options().thresholds), cells, counts);
  });
  return counts;
}

}  // namespace pingvox
