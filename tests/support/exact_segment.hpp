#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pingvox::test {

/// A segment through a grid of unit cells in exact (rational) arithmetic: its ends are whole multiples of 2^-40 of a
/// cell, less than 2^22 cells from the origin, so that all products fit into 128 bits.
class ExactSegment {
 public:
  __extension__ typedef __int128 Wide;
  using Point = std::array<std::int64_t, 3>;  ///< in units of 2^-40 of a cell
  using Cell = std::array<std::int64_t, 3>;
  static constexpr int kShift = 40;
  static constexpr std::int64_t kUnit = std::int64_t{1} << kShift;
  /// A little less than 1e-9 of a cell.
  static constexpr std::int64_t kGraze = std::int64_t{1} << (kShift - 30);

  ExactSegment(const Point& from, const Point& to) : from_(from), to_(to) {}

  static Cell cell_of(const Point& point) { return {point[0] >> kShift, point[1] >> kShift, point[2] >> kShift}; }

  /// The cells that it crosses, in order, without the last one; several faces crossed at once are taken z, y, x.
  std::vector<Cell> cells() const {
    std::vector<Cell> all;
    Cell at = cell_of(from_);
    const Cell last = cell_of(to_);
    while (at != last) {
      all.push_back(at);
      std::size_t next = 3;
      for (std::size_t axis = 3; axis-- > 0;) {
        if (at[axis] != last[axis] && (next == 3 || is_sooner(at, axis, next))) next = axis;
      }
      at[next] += at[next] < last[next] ? 1 : -1;
    }
    return all;
  }

  /// Whether it comes into a (closed) cell that is made larger by `margin` on all sides, or smaller if negative.
  bool meets(const Cell& cell, std::int64_t margin) const {
    // Where along the segment it is between the faces of each axis: from the latest entry to the earliest exit.
    Share in{0, 1}, out{1, 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t along = to_[axis] - from_[axis];
      const std::int64_t low = (cell[axis] << kShift) - margin - from_[axis];
      const std::int64_t high = ((cell[axis] + 1) << kShift) + margin - from_[axis];
      if (along == 0) {
        if (low > 0 || high < 0) return false;
        continue;
      }
      const Share enters = along > 0 ? Share{low, along} : Share{-high, -along};
      const Share leaves = along > 0 ? Share{high, along} : Share{-low, -along};
      if (in < enters) in = enters;
      if (leaves < out) out = leaves;
    }
    return !(out < in);
  }

 private:
  struct Share {
    std::int64_t above, below;  ///< below > 0
    friend bool operator<(const Share& a, const Share& b) {
      return static_cast<Wide>(a.above) * b.below < static_cast<Wide>(b.above) * a.below;
    }
  };

  Share next_face(const Cell& at, std::size_t axis) const {
    const std::int64_t along = to_[axis] - from_[axis];
    if (along > 0) return {((at[axis] + 1) << kShift) - from_[axis], along};
    return {from_[axis] - (at[axis] << kShift), -along};
  }
  bool is_sooner(const Cell& at, std::size_t a, std::size_t b) const { return next_face(at, a) < next_face(at, b); }

  Point from_, to_;
};

}  // namespace pingvox::test
