#include "pingvox/map/cast_ray.hpp"

#include <algorithm>
#include <cmath>

#include "pingvox/map/ray_dda.hpp"

namespace pingvox {
namespace {

/// Share of the way that lies inside of the lattice, but for rounding: a bound that keeps numbers small, not the
/// border.
double share_inside(const Lattice& lattice, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& way_m) {
  const double border_m = 0.5 * lattice.cell_size_m(0);
  double share = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double room_m = way_m[axis] > 0.0 ? border_m - origin_m[axis] : border_m + origin_m[axis];
    const double length_m = std::abs(way_m[axis]);
    if (length_m > room_m) share = std::min(share, std::max(0.0, room_m / length_m));
  }
  return share;
}

template <KeyWord W>
RayEnd cast(const OccupancyMap& map, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& way_m,
            UnknownCells unknown) {
  const Lattice& lattice = map.lattice();
  const auto start = lattice.key_of<W>(origin_m);
  if (!start) return {Occupancy::kUnknown, {}, 0.0};
  const double range_m = way_m.norm();
  const double cells_per_m = 1.0 / lattice.resolution_m();
  FaceCrossings crossings(origin_m * cells_per_m, (origin_m + way_m) * cells_per_m);
  const W last = static_cast<W>((W{1} << (lattice.depth() - 1)) - 1 + (W{1} << (lattice.depth() - 1)));
  BasicKey<W> key = *start;
  double entered_m = 0.0;
  for (;;) {
    const Occupancy what = map.classify(key);
    const bool blocks = what == Occupancy::kUnknown && unknown == UnknownCells::kBlock;
    if (what == Occupancy::kOccupied || blocks) return {what, key.template as<WideWord>(), entered_m};
    if (crossings.left() == 0) return {Occupancy::kFree, key.template as<WideWord>(), range_m};
    entered_m = crossings.share_at_next() * range_m;
    const std::size_t axis = crossings.next_axis();
    const bool is_ahead = crossings.is_ahead(axis);
    W& word = component(key, axis);
    // An end that was rounded onto the border of the lattice would wrap around to its other side.
    if (word == (is_ahead ? last : W{0})) return {Occupancy::kFree, key.template as<WideWord>(), entered_m};
    word = static_cast<W>(is_ahead ? word + 1 : word - 1);
    crossings.cross(axis);
  }
}

}  // namespace

RayEnd cast_ray(const OccupancyMap& map, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                double max_range_m, UnknownCells unknown) {
  assert(direction.norm() > 0.0 && max_range_m > 0.0 && std::isfinite(max_range_m));
  const Eigen::Vector3d way_m = direction.normalized() * max_range_m;
  // Farther than 2^60 cells no walk ends.
  const double most_m = std::ldexp(map.lattice().resolution_m(), 60);
  const Eigen::Vector3d inside_m = way_m * std::min(share_inside(map.lattice(), origin_m, way_m), most_m / max_range_m);
  return with_key_word(map.lattice().depth(), [&]<KeyWord W>() { return cast<W>(map, origin_m, inside_m, unknown); });
}

}  // namespace pingvox
