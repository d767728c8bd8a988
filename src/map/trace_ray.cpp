#include "pingvox/map/trace_ray.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "map/tree_order.hpp"
#include "pingvox/geometry/ray_bresenham.hpp"
#include "pingvox/geometry/ray_dda.hpp"

namespace pingvox {
namespace {

/// Bits of the x axis in a number in the tree's order; those of y and z are one and two places higher.
constexpr std::uint64_t kBitsOfX = detail::spread_bits(0x1FFFFF);
/// Deeper lattices have more bits than such a number.
constexpr int kMaxDepth = 21;

/// Position of a ray along one axis.
class Axis {
 public:
  /// @param start  number of the first cell in the tree's order
  Axis(const FaceCrossings& crossings, std::size_t axis, std::uint64_t start) : bits_(kBitsOfX << axis) {
    const FaceCrossings::OneAxis along = crossings.along(axis);
    left_ = along.left;
    next_ = along.next;
    // Behind its only face nothing is left.
    apart_ = left_ > 1 ? along.apart : FaceCrossings::OneAxis::kNever - next_;
    place_ = start & bits_;
    // Added before the bits of the other axes are masked: a carry must run through them.
    const std::uint64_t lowest = bits_ & (~bits_ + 1);
    step_ = crossings.is_ahead(axis) ? ~bits_ + 1 : ~lowest + 1;
  }

  std::uint64_t left() const { return left_; }  ///< faces at the start of the ray
  std::uint64_t next() const { return next_; }
  std::uint64_t apart() const { return apart_; }
  std::uint64_t place() const { return place_; }  ///< its bits of the cell's number
  std::uint64_t last() const { return next_ + (left_ - 1) * apart_; }

  void cross() {
    next_ += apart_;
    place_ = (place_ + step_) & bits_;
  }
  /// Without a branch: the next face cannot be predicted.
  void cross_if(bool is_due) {
    const std::uint64_t mask = ~std::uint64_t{is_due} + 1;
    next_ += apart_ & mask;
    place_ = (place_ + (step_ & mask)) & bits_;
  }

 private:
  std::uint64_t bits_, left_ = 0, next_ = 0, apart_ = 0, place_ = 0, step_ = 0;
};

/// Missed cells of one brick.
struct BrickCells {
  std::uint64_t brick;  ///< its number in the tree's order
  std::uint64_t cells;  ///< a bit each
};

void mark(std::span<const BrickCells> bricks, ScanUpdate& scan) {
  constexpr int kBits = ScanUpdate::kPageBits;
  std::uint64_t number = std::numeric_limits<std::uint64_t>::max();
  std::uint32_t page = 0;
  for (const BrickCells& one : bricks) {
    if (one.brick / 64 != number) {
      number = one.brick / 64;
      const auto at = detail::key_of_code(number);
      page = scan.page_of(WideKey{at.x << kBits, at.y << kBits, at.z << kBits});
    }
    scan.mark_missed_in(page, one.brick % 64, one.cells);
  }
}

/// Walks a ray of few faces: the cells of `dda`, by their numbers in the tree's order. Between two faces of the axis
/// with most of them lies at most one face of each other axis, so that what is left to find out in each step is whether
/// it is due.
class Walk {
 public:
  Walk(const FaceCrossings& crossings, std::uint64_t start)
      : axes_{Axis(crossings, 0, start), Axis(crossings, 1, start), Axis(crossings, 2, start)},
        left_(crossings.left()),
        brick_(start / 64) {}

  /// Whether sums alone tell the order of the faces: behind the last face of an axis comes none before the ray's last.
  bool is_exact() const {
    std::uint64_t last = 0, beyond = FaceCrossings::OneAxis::kNever;
    for (const Axis& axis : axes_) {
      if (axis.left() > 0) last = std::max(last, axis.last());
      if (axis.left() > 1) beyond = std::min(beyond, axis.last() + axis.apart());
    }
    return left_ <= FaceCrossings::kMaxFacesIn64Bits && beyond > last;
  }

  void mark_missed(ScanUpdate& scan) {
    // The axis with the smallest distance from face to face; of one face or none there is no distance.
    std::size_t major = 0;
    for (std::size_t a = 1; a < 3; ++a) {
      const bool has_distance = axes_[a].left() > 1;
      if (has_distance && (axes_[major].left() < 2 || axes_[a].apart() < axes_[major].apart())) major = a;
    }
    const std::uint64_t faces = axes_[major].left();
    if (faces > 1) {
      // What comes before its first face is not bound to that distance.
      while (step(scan) != major) {
      }
      const std::size_t a = major == 0 ? 1 : 0, b = major == 2 ? 1 : 2;
      if (axes_[a].left() == 0) {
        step_along<1>(major, b, a, faces - 1, scan);
      } else if (axes_[b].left() == 0) {
        step_along<1>(major, a, b, faces - 1, scan);
      } else {
        step_along<2>(major, a, b, faces - 1, scan);
      }
    }
    while (left_ > 0) step(scan);
    hand_over(scan);
  }

 private:
  static constexpr std::size_t kRoom = 256;

  /// Marks the cell and crosses the next face. @return its axis
  std::size_t step(ScanUpdate& scan) {
    const std::size_t axis = axis_of_min(std::array{axes_[0].next(), axes_[1].next(), axes_[2].next()});
    add(axes_[0].place() | axes_[1].place() | axes_[2].place(), brick_, cells_, used_);
    if (used_ + 4 > kRoom) hand_over(scan);
    axes_[axis].cross();
    --left_;
    return axis;
  }

  /// Crosses so many faces of one axis, and those of the `Others` other axes that come before each. REQUIRES a < b
  /// where there are two.
  template <int Others>
  void step_along(std::size_t major, std::size_t a, std::size_t b, std::uint64_t faces, ScanUpdate& scan) {
    // By themselves, not as members, which would be stored in each step.
    Axis along = axes_[major], first = axes_[a], second = axes_[b];
    std::uint64_t brick = brick_, cells = cells_, crossed = 0;
    std::size_t used = used_;
    // Of faces that are crossed at once the last axis comes first, as in axis_of_min.
    const std::uint64_t first_wins = a > major ? 1 : 0, second_wins = b > major ? 1 : 0;
    for (std::uint64_t n = 0; n < faces; ++n) {
      const bool is_first = first.next() < along.next() + first_wins;
      add(along.place() | first.place() | second.place(), brick, cells, used);
      if constexpr (Others == 1) {
        first.cross_if(is_first);
      } else {
        const bool is_second = second.next() < along.next() + second_wins;
        const bool is_first_before = is_first && (!is_second || first.next() < second.next());
        const std::uint64_t first_place = first.place(), second_place = second.place();
        first.cross_if(is_first);
        second.cross_if(is_second);
        const std::uint64_t between = is_first_before ? first.place() | second_place : first_place | second.place();
        add(along.place() | between, brick, cells, used);
        crossed += is_second;
      }
      add(along.place() | first.place() | second.place(), brick, cells, used);
      crossed += is_first;
      along.cross();
      if (used + 4 > kRoom) {
        used_ = used;
        hand_over(scan);
        used = 0;
        cells = 0;
      }
    }
    axes_[major] = along;
    axes_[a] = first;
    axes_[b] = second;
    brick_ = brick;
    cells_ = cells;
    used_ = used;
    left_ -= faces + crossed;
  }

  /// Adds a cell, as often as one likes.
  void add(std::uint64_t cell, std::uint64_t& brick, std::uint64_t& cells, std::size_t& used) {
    const bool is_other = cell / 64 != brick;
    brick = cell / 64;
    used += is_other;
    cells = (is_other ? 0 : cells) | std::uint64_t{1} << (cell % 64);
    marked_[used] = {brick, cells};
  }

  void hand_over(ScanUpdate& scan) {
    mark(std::span(marked_).first(used_ + 1), scan);
    used_ = 0;
    cells_ = 0;
  }

  std::array<Axis, 3> axes_;
  std::uint64_t left_;               ///< faces
  std::uint64_t brick_, cells_ = 0;  ///< the last entry of marked_
  std::size_t used_ = 0;             ///< the entries before it
  std::array<BrickCells, kRoom> marked_;
};

/// Marks cell after cell, asking for a page only when the ray enters one.
class Marker {
 public:
  explicit Marker(ScanUpdate& scan) : scan_(scan) {}

  template <KeyWord W>
  void miss(const BasicKey<W>& key) {
    const BasicKey<W> page{static_cast<W>(key.x >> kBits), static_cast<W>(key.y >> kBits),
                           static_cast<W>(key.z >> kBits)};
    if (!inside_ || page.template as<WideWord>() != page_key_) {
      page_ = scan_.page_of(key.template as<WideWord>());
      page_key_ = page.template as<WideWord>();
      inside_ = true;
    }
    scan_.mark_missed(page_, ScanUpdate::cell_in_page(key));
  }

 private:
  static constexpr int kBits = ScanUpdate::kPageBits;
  ScanUpdate& scan_;
  WideKey page_key_;
  std::uint32_t page_ = 0;
  bool inside_ = false;
};

template <KeyWord W>
bool trace(const Lattice& lattice, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, RayAlgorithm algorithm,
           ScanUpdate& scan) {
  Marker marker(scan);
  if (algorithm == RayAlgorithm::kDda) {
    auto ray = dda_stepper<W>(lattice, from_m, to_m);
    if (!ray) return false;
    if (ray->done()) return true;
    if (lattice.depth() <= kMaxDepth) {
      Walk walk(ray->crossings(), detail::code_of(ray->key()));
      if (walk.is_exact()) {
        walk.mark_missed(scan);
        return true;
      }
    }
    for (const BasicKey<W> key : KeyRange(*ray)) marker.miss(key);
    return true;
  }
  const auto from = lattice.key_of<W>(from_m), to = lattice.key_of<W>(to_m);
  if (!from || !to) return false;
  for (const BasicKey<W> key : bresenham(*from, *to)) marker.miss(key);
  return true;
}

}  // namespace

bool trace_ray(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, RayAlgorithm algorithm, ScanUpdate& scan) {
  const Lattice& lattice = scan.lattice();
  return with_key_word(lattice.depth(), [&]<KeyWord W>() { return trace<W>(lattice, from_m, to_m, algorithm, scan); });
}

}  // namespace pingvox
