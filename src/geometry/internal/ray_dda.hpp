#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "geometry/internal/key_range.hpp"
#include "pingvox/geometry/lattice.hpp"

namespace pingvox {

/// Axis of the least of three numbers; of equal ones the one that liboctomap takes, the last.
template <class Number>
constexpr std::size_t axis_of_min(const std::array<Number, 3>& next) {
  if (next[0] < next[1]) return next[0] < next[2] ? 0 : 2;
  return next[1] < next[2] ? 1 : 2;
}

/// The order in which a segment crosses the faces between cells (Amanatides & Woo 1987), on integers: crossings of an
/// axis lie at first + n * apart along the segment, and each axis has a known number of them. So no rounding can miss
/// the end or run past it, as happens in the paper's figures 11 and 12. Crossings are compared in units of
/// 2^-62 of the segment's length. Up to kMaxFacesIn64Bits they are added up in these units, too; beyond in units of
/// 2^-126, or a long ray would drift.
class FaceCrossings {
 public:
  /// Sums over so many faces stay within 1e-9 of a cell in units of 2^-62 (tracers of many rays rely on these).
  static constexpr std::uint64_t kMaxFacesIn64Bits = 32768;

  /// @param from, to  ends of the segment in cells (metres times cells per metre)
  /// REQUIRES finite ends with |floor(to) - floor(from)| < 2^62 along each axis
  FaceCrossings(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      const double first_cell = std::floor(from[axis]), last_cell = std::floor(to[axis]);
      const double along = to[axis] - from[axis];
      ahead_[i] = last_cell >= first_cell;
      left_[i] = static_cast<std::uint64_t>(std::abs(last_cell - first_cell));
      total_ += left_[i];
      if (left_[i] == 0) continue;
      const double to_face = ahead_[i] ? first_cell + 1.0 - from[axis] : from[axis] - first_cell;
      next_[i] = static_cast<std::uint64_t>(std::ldexp(to_face / std::abs(along), 62));
      // A segment with one crossing may be so short that its inverse is no number.
      if (left_[i] == 1) continue;
      const auto apart = static_cast<WideWord>(std::ldexp(1.0 / std::abs(along), 126));
      apart_[i] = static_cast<std::uint64_t>(apart >> 64);
      below_apart_[i] = static_cast<std::uint64_t>(apart);
    }
    is_long_ = total_ > kMaxFacesIn64Bits;
  }

  /// Faces that are left to cross: the Manhattan distance of the two cells.
  std::uint64_t left() const { return total_; }
  /// Axis of the next face; of several crossed at once the one that liboctomap takes. REQUIRES left() > 0.
  std::size_t next_axis() const { return axis_of_min(next_); }
  /// Whether the key component grows along an axis.
  bool is_ahead(std::size_t axis) const { return ahead_[axis]; }
  /// Crosses the next face, which must be that of `axis`. REQUIRES left() > 0.
  void cross(std::size_t axis) {
    --total_;
    // Which axis comes next is as good as random: there are no branches on it.
    cross_if<0>(axis);
    cross_if<1>(axis);
    cross_if<2>(axis);
  }
  /// Where the next face lies along the segment, 0..1. REQUIRES left() > 0.
  double share_at_next() const { return std::ldexp(static_cast<double>(next_[next_axis()]), -62); }

  /// The remaining crossings along one axis, for tracers that count by themselves.
  struct OneAxis {
    static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t next = kNever;  ///< the next face, in units of 2^-62 of the segment; kNever: none left
    std::uint64_t apart = 0;      ///< from face to face; right up to kMaxFacesIn64Bits
    std::uint64_t left = 0;
  };
  OneAxis along(std::size_t axis) const { return {next_[axis], apart_[axis], left_[axis]}; }

 private:
  static constexpr std::uint64_t kNever = OneAxis::kNever;

  /// Crosses the next face of axis A if that is `axis`. No loop over A: so all numbers stay in registers.
  template <std::size_t A>
  void cross_if(std::size_t axis) {
    const std::uint64_t is_crossed = A == axis ? 1 : 0;
    if (is_long_) {
      const std::uint64_t before = below_next_[A];
      below_next_[A] += below_apart_[A] & (0 - is_crossed);
      next_[A] += below_next_[A] < before ? 1 : 0;
    }
    left_[A] -= is_crossed;
    next_[A] = left_[A] == 0 ? kNever : next_[A] + (apart_[A] & (0 - is_crossed));
  }

  std::array<std::uint64_t, 3> next_{kNever, kNever, kNever}, apart_{}, left_{};
  std::array<std::uint64_t, 3> below_next_{}, below_apart_{};  ///< in units of 2^-126: of long segments alone
  bool is_long_ = false;
  std::array<bool, 3> ahead_{};
  std::uint64_t total_ = 0;
};

/// Component of a key along an axis 0..2.
template <KeyWord W>
constexpr W& component(BasicKey<W>& key, std::size_t axis) {
  return axis == 0 ? key.x : (axis == 1 ? key.y : key.z);
}

/// Walks the cells that a segment crosses, face by face.
template <KeyWord W>
class DdaStepper {
 public:
  DdaStepper(const BasicKey<W>& start, const FaceCrossings& crossings) : key_(start), crossings_(crossings) {}
  BasicKey<W> key() const { return key_; }
  bool done() const { return crossings_.left() == 0; }
  void step() {
    const std::size_t axis = crossings_.next_axis();
    const auto step_if = [&](std::size_t of, W word) {
      const W step = static_cast<W>(axis == of ? 1 : 0);
      return static_cast<W>(crossings_.is_ahead(of) ? word + step : word - step);
    };
    key_ = {step_if(0, key_.x), step_if(1, key_.y), step_if(2, key_.z)};
    crossings_.cross(axis);
  }

 private:
  BasicKey<W> key_;
  FaceCrossings crossings_;
};

/// The cells that the segment from `from_m` to `to_m` [m, map frame] crosses, the start cell included, the end cell
/// not. Against exact arithmetic only cells that it touches within 1e-9 of a cell of a face, edge or corner may differ.
/// @return nullopt when an end lies outside of the lattice
template <KeyWord W>
std::optional<KeyRange<DdaStepper<W>>> dda(const Lattice& lattice, const Eigen::Vector3d& from_m,
                                           const Eigen::Vector3d& to_m) {
  const auto start = lattice.key_of<W>(from_m);
  if (!start || !lattice.key_of<W>(to_m)) return std::nullopt;
  const Eigen::Vector3d from = lattice.in_cells(from_m), to = lattice.in_cells(to_m);
  // Farther than 2^62 cells no walk ends; such an end is as good as outside.
  if (!((to - from).cwiseAbs().maxCoeff() < std::ldexp(1.0, 61))) return std::nullopt;
  return KeyRange(DdaStepper<W>(*start, FaceCrossings(from, to)));
}

}  // namespace pingvox
