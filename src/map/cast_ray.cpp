#include "pingvox/map/cast_ray.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/internal/ray_dda.hpp"
#include "map/entry_walk.hpp"
#include "map/map_access.hpp"
#include "pingvox/geometry/direction.hpp"

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
W last_cell(const Lattice& lattice) {
  return static_cast<W>((W{1} << (lattice.depth() - 1)) - 1 + (W{1} << (lattice.depth() - 1)));
}

/// Whether a ray ends at a cell.
bool stops(Occupancy what, UnknownCells unknown) {
  return what == Occupancy::kOccupied || (what == Occupancy::kUnknown && unknown == UnknownCells::kBlock);
}

/// Cell by cell, each from the root, for rays of any length.
template <KeyWord W>
RayEnd cast_far(const OccupancyMap& map, BasicKey<W> key, FaceCrossings crossings, double range_m,
                UnknownCells unknown) {
  const W last = last_cell<W>(map.lattice());
  double entered_m = 0.0;
  for (;;) {
    const Occupancy what = map.classify(key);
    if (stops(what, unknown)) return {what, key.template as<WideWord>(), entered_m};
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

/// The cell of a brick at a place: 4 bits an axis, of which the lower two count.
constexpr auto kCellAt = [] {
  std::array<std::uint8_t, 0x334> cells{};
  for (unsigned place = 0; place < cells.size(); ++place) {
    const BasicKey<std::uint8_t> key{static_cast<std::uint8_t>(place & 3), static_cast<std::uint8_t>(place >> 4 & 3),
                                     static_cast<std::uint8_t>(place >> 8 & 3)};
    cells[place] = static_cast<std::uint8_t>(detail::cell_in_brick(key));
  }
  return cells;
}();

/// The same ray node by node: within a brick by its bits, and where the tree has no brick to the node's last face at
/// once. The faces are those of FaceCrossings, in its order (of those crossed at once the highest axis first), so a ray
/// ends where `cast_far` ends it. REQUIRES at most FaceCrossings::kMaxFacesIn64Bits, and two levels or more.
template <KeyWord W>
class NodeWalk {
 public:
  NodeWalk(const OccupancyMap& map, const BasicKey<W>& start, const FaceCrossings& crossings, UnknownCells unknown)
      : tree_(detail::MapAccess::tree(map)),
        thresholds_(map.options().thresholds),
        unknown_(unknown),
        last_(last_cell<W>(map.lattice())),
        entries_(tree_),
        key_{start.x, start.y, start.z},
        left_(crossings.left()) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      axis_[axis] = crossings.along(axis);
      ahead_[axis] = crossings.is_ahead(axis);
    }
  }

  RayEnd end(double range_m) {
    Stop stop = Stop::kNot;
    while (stop == Stop::kNot) {
      const detail::Entry entry = entries_.to(key());
      stop = entry.is_inner() ? cross(tree_.bricks[entry.link]) : cross(entry, tree_.levels - entries_.depth());
    }
    const double entered_m = std::ldexp(static_cast<double>(entered_), -62) * range_m;
    return {what_, key().template as<WideWord>(), stop == Stop::kEndOfRay ? range_m : entered_m};
  }

 private:
  static constexpr std::uint64_t kNever = FaceCrossings::OneAxis::kNever;
  enum class Stop { kNot, kAtCell, kBorder, kEndOfRay };

  BasicKey<W> key() const { return {key_[0], key_[1], key_[2]}; }

  /// Goes on until the ray has left the node without a brick that is so many levels high.
  Stop cross(const detail::Entry& entry, int levels) {
    const Occupancy what = entry.is_none() ? Occupancy::kUnknown : classify(LogOdds(entry.value), thresholds_);
    if (stops(what, unknown_)) return stop_at(what);
    const W inner_bits = static_cast<W>(levels < kLevelsOf<W> ? (W{1} << levels) - 1 : ~W{0});
    // Faces to cross within the node, and when the one behind them, which is the node's, is crossed.
    std::array<std::uint64_t, 3> within{}, leaves{kNever, kNever, kNever};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const W behind = key_[axis] & inner_bits;
      const W room = ahead_[axis] ? static_cast<W>(inner_bits - behind) : behind;
      if (room >= axis_[axis].left) continue;
      within[axis] = static_cast<std::uint64_t>(room);
      leaves[axis] = axis_[axis].next + within[axis] * axis_[axis].apart;
    }
    const std::size_t out = first_of(leaves);
    if (leaves[out] == kNever) {
      for (std::size_t axis = 0; axis < 3; ++axis) advance(axis, axis_[axis].left);
      return Stop::kEndOfRay;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      advance(axis, axis == out ? within[out] : faces_before(leaves[out] + (axis > out ? 1 : 0), axis_[axis]));
    }
    entered_ = leaves[out];
    if (key_[out] == (ahead_[out] ? last_ : W{0})) return Stop::kBorder;
    advance(out, 1);
    return Stop::kNot;
  }

  static std::size_t first_of(const std::array<std::uint64_t, 3>& when) {
    if (when[0] < when[1]) return when[0] < when[2] ? 0 : 2;
    return when[1] < when[2] ? 1 : 2;
  }

  /// How many faces of an axis are crossed before `when`.
  static std::uint64_t faces_before(std::uint64_t when, const FaceCrossings::OneAxis& axis) {
    if (axis.next >= when) return 0;
    if (axis.left == 1) return 1;
    return std::min(axis.left, (when - 1 - axis.next) / axis.apart + 1);
  }

  void advance(std::size_t axis, std::uint64_t faces) {
    if (faces == 0) return;
    const W words = static_cast<W>(faces);
    key_[axis] = static_cast<W>(ahead_[axis] ? key_[axis] + words : key_[axis] - words);
    axis_[axis].left -= faces;
    left_ -= faces;
    axis_[axis].next = axis_[axis].left == 0 ? kNever : axis_[axis].next + faces * axis_[axis].apart;
  }

  /// Goes on from cell to cell until the ray has left the brick. Which face comes next is as good as random: there are
  /// no branches on it.
  Stop cross(detail::BrickView brick) {
    // Of each axis 4 bits with 4 + the cell's place in the brick: out of it are 3 and 8.
    constexpr std::uint32_t kHigh = 0xCCC, kIn = 0x444, kLow = 0x333;
    std::uint32_t place = kIn + static_cast<std::uint32_t>(key_[0] & 3) +
                          (static_cast<std::uint32_t>(key_[1] & 3) << 4) +
                          (static_cast<std::uint32_t>(key_[2] & 3) << 8);
    const auto step_of = [&](std::size_t axis) { return (ahead_[axis] ? 1U : ~0U) * (1U << (4 * axis)); };
    const std::uint32_t step_x = step_of(0), step_y = step_of(1), step_z = step_of(2);
    FaceCrossings::OneAxis x = axis_[0], y = axis_[1], z = axis_[2];
    std::uint64_t left = left_, entered = entered_;
    Stop stop = Stop::kNot;
    while ((place & kHigh) == kIn) {
      const std::size_t cell = kCellAt[place & kLow];
      const bool known = (brick.known >> cell & 1) != 0;
      const Occupancy what = known ? classify(LogOdds(brick.value[cell]), thresholds_) : Occupancy::kUnknown;
      if (stops(what, unknown_)) {
        stop = stop_at(what);
        break;
      }
      if (left == 0) {
        stop = Stop::kEndOfRay;
        break;
      }
      --left;
      const bool is_x = (x.next < y.next) & (x.next < z.next);
      const bool is_y = !(x.next < y.next) & (y.next < z.next);
      const bool is_z = !(is_x | is_y);
      entered = is_x ? x.next : (is_y ? y.next : z.next);
      place += (step_x & mask_of(is_x)) + (step_y & mask_of(is_y)) + (step_z & mask_of(is_z));
      cross_if(is_x, x);
      cross_if(is_y, y);
      cross_if(is_z, z);
    }
    axis_ = {x, y, z};
    left_ = left;
    entered_ = entered;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const W lowest = key_[axis] & ~W{3};
      const W in_brick = static_cast<W>(place >> (4 * axis) & 0xF);
      const bool crosses_border = (in_brick == 3 && lowest == 0) || (in_brick == 8 && lowest + 3 == last_);
      if (crosses_border) stop = Stop::kBorder;
      key_[axis] = crosses_border ? (in_brick == 3 ? W{0} : last_) : static_cast<W>(lowest + in_brick - 4);
    }
    return stop;
  }

  static std::uint32_t mask_of(bool is) { return 0U - static_cast<std::uint32_t>(is); }

  static void cross_if(bool is, FaceCrossings::OneAxis& axis) {
    axis.left -= is ? 1 : 0;
    axis.next += axis.apart & (0 - std::uint64_t{is});
    axis.next = axis.left == 0 ? kNever : axis.next;
  }

  Stop stop_at(Occupancy what) {
    what_ = what;
    return Stop::kAtCell;
  }

  const detail::BrickTree& tree_;
  Thresholds thresholds_;
  UnknownCells unknown_;
  W last_;
  detail::EntryWalk<W> entries_;
  std::array<W, 3> key_;
  std::array<FaceCrossings::OneAxis, 3> axis_;
  std::array<bool, 3> ahead_{};
  std::uint64_t left_;
  std::uint64_t entered_ = 0;  ///< when the ray entered its cell, in units of 2^-62 of its length
  Occupancy what_ = Occupancy::kFree;
};

template <KeyWord W>
RayEnd cast(const OccupancyMap& map, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& way_m,
            UnknownCells unknown) {
  const Lattice& lattice = map.lattice();
  const auto start = lattice.key_of<W>(origin_m);
  if (!start) return {Occupancy::kUnknown, {}, 0.0};
  const FaceCrossings crossings(lattice.in_cells(origin_m), lattice.in_cells(origin_m + way_m));
  const double range_m = way_m.norm();
  if (lattice.depth() < 2 || crossings.left() > FaceCrossings::kMaxFacesIn64Bits) {
    return cast_far(map, *start, crossings, range_m, unknown);
  }
  return NodeWalk<W>(map, *start, crossings, unknown).end(range_m);
}

}  // namespace

RayEnd cast_ray(const OccupancyMap& map, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                double max_range_m, UnknownCells unknown) {
  assert(direction.allFinite() && !direction.isZero(0.0) && max_range_m > 0.0 && std::isfinite(max_range_m));
  const Eigen::Vector3d way_m = unit_vector(direction) * max_range_m;
  // Farther than 2^60 cells no walk ends.
  const double max_m = std::ldexp(map.lattice().resolution_m(), 60);
  const Eigen::Vector3d inside_m = way_m * std::min(share_inside(map.lattice(), origin_m, way_m), max_m / max_range_m);
  if (map.lattice().depth() <= kLevelsOf<std::uint64_t>) return cast<std::uint64_t>(map, origin_m, inside_m, unknown);
  return cast<WideWord>(map, origin_m, inside_m, unknown);
}

}  // namespace pingvox
