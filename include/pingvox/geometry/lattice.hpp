#pragma once

#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "pingvox/geometry/key.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The grid of one map, and the only code that turns metres into keys and back. A cube of 2^depth cells along each
/// axis, centred on the origin of the map frame.
class Lattice {
 public:
  static constexpr int kDefaultDepth = 16;

  /// @param resolution_m  edge of a cell of the finest resolution [m], > 0 and finite
  /// @param depth         levels below the root, 1..kMaxDepth
  /// @return kBadOption when one of the two is out of its range, or the lattice's edge is not finite
  static Result<Lattice> make(double resolution_m, int depth = kDefaultDepth);

  /// REQUIRES what `make` checks.
  explicit Lattice(double resolution_m, int depth = kDefaultDepth);

  double resolution_m() const { return resolution_m_; }
  int depth() const { return depth_; }

  /// Factor from metres to cells, used everywhere: dividing by the resolution rounds differently, and could put a point
  /// on a face into the neighbouring cell.
  double cells_per_m() const { return cells_per_m_; }
  /// A point [m, map frame] in cells, counted from the centre of the lattice. Its cell's key is the floor of it.
  Eigen::Vector3d in_cells(const Eigen::Vector3d& point_m) const { return point_m * cells_per_m_; }

  /// Edge [m] of a cell at `depth`. REQUIRES 0 <= depth <= this->depth().
  double cell_size_m(int depth) const {
    // A factor of 2^levels, by its exponent: exact, and quicker than ldexp.
    return resolution_m_ * std::bit_cast<double>(static_cast<std::uint64_t>(1023 + depth_ - depth) << 52);
  }

  /// The cell of the finest resolution that holds a point.
  /// @param point_m  map frame [m]
  /// @return nullopt: outside of the lattice, or NaN. Equals liboctomap's coordToKeyChecked for 16 levels.
  template <KeyWord W>
  std::optional<BasicKey<W>> key_of(const Eigen::Vector3d& point_m) const {
    assert(depth_ <= kLevelsOf<W>);
    const auto x = word_of<W>(point_m.x()), y = word_of<W>(point_m.y()), z = word_of<W>(point_m.z());
    if (!x || !y || !z) return std::nullopt;
    return BasicKey<W>{*x, *y, *z};
  }
  /// The same for the default width. REQUIRES depth() <= 16.
  std::optional<Key> key_of(const Eigen::Vector3d& point_m) const { return key_of<std::uint16_t>(point_m); }

  /// Middle [m] of the cell at `depth` that holds `key`. Equals liboctomap's keyToCoord for 16 levels.
  template <KeyWord W>
  Eigen::Vector3d centre_of(const BasicKey<W>& key, int depth) const {
    const int shift = depth_ - depth;
    return {middle(key.x, shift), middle(key.y, shift), middle(key.z, shift)};
  }
  /// Middle [m] of a cell of the finest resolution.
  template <KeyWord W>
  Eigen::Vector3d centre_of(const BasicKey<W>& key) const {
    return centre_of(key, depth_);
  }

  /// Lowest corner [m] of the cell at `depth` that holds `key`.
  template <KeyWord W>
  Eigen::Vector3d lowest_corner_of(const BasicKey<W>& key, int depth) const {
    return centre_of(key, depth).array() - 0.5 * cell_size_m(depth);
  }

  friend bool operator==(const Lattice& a, const Lattice& b) {
    return a.resolution_m_ == b.resolution_m_ && a.depth_ == b.depth_;
  }

 private:
  __extension__ typedef __int128 SignedWide;

  template <KeyWord W>
  std::optional<W> word_of(double m) const {
    // Times the inverse, as OctoMap does: dividing puts 0.3 m at 0.1 m cells one cell lower.
    const double cell = m * cells_per_m_;
    if (!(cell >= -half_ && cell < half_)) return std::nullopt;  // this way round NaN fails too
    const W centre = static_cast<W>(W{1} << (depth_ - 1));
    if (depth_ > 62) return static_cast<W>(static_cast<W>(static_cast<SignedWide>(std::floor(cell))) + centre);
    // The same by the processor's own conversion, which rounds towards zero: many times faster.
    auto whole = static_cast<std::int64_t>(cell);
    if (static_cast<double>(whole) > cell) --whole;
    return static_cast<W>(static_cast<W>(whole) + centre);
  }

  template <KeyWord W>
  double middle(W word, int shift) const {
    // A node spans 2^shift words; its index is counted from the centre of the lattice.
    if (shift >= depth_) return 0.0;
    const WideWord half = WideWord{1} << (depth_ - 1 - shift);
    // At 128 levels the key itself needs all 128 bits: subtract in unsigned arithmetic, which wraps to the right value.
    const WideWord index = static_cast<WideWord>(word) >> shift;
    const double size_m = shift == 0 ? resolution_m_ : std::ldexp(resolution_m_, shift);
    // The same by the processor's own conversion where 64 bits hold it.
    if (depth_ <= 62) return (static_cast<double>(static_cast<std::int64_t>(index - half)) + 0.5) * size_m;
    return (static_cast<double>(static_cast<SignedWide>(index - half)) + 0.5) * size_m;
  }

  double resolution_m_;
  double cells_per_m_;
  double half_;  ///< cells from the centre to the border
  int depth_;
};

}  // namespace pingvox
