#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "map/pool.hpp"
#include "pingvox/geometry/key.hpp"
#include "pingvox/map/tree_view.hpp"

namespace pingvox::detail {

/// A brick to be written to, by itself or in a tree.
struct BrickRef {
  BrickRef(Brick& brick) : known(brick.known), value(brick.value) {}
  BrickRef(std::uint64_t& known_cells, CellValues& values) : known(known_cells), value(values) {}
  operator BrickView() const { return {known, value}; }
  std::uint64_t& known;
  CellValues& value;
};

/// Bricks by index. The masks of known cells are stored apart from the values: many queries read only the masks, and
/// the values fill whole cache lines.
class BrickPool {
 public:
  BrickRef operator[](std::uint32_t index) { return {known_[index], value_[index]}; }
  BrickView operator[](std::uint32_t index) const { return {known_[index], value_[index]}; }

  /// A new brick. Throws std::bad_alloc; then the others are as they were.
  std::uint32_t allocate(const Brick& brick) {
    const std::uint32_t index = known_.allocate(brick.known);
    try {
      value_.allocate(brick.value);
    } catch (...) {
      known_.release(index);
      throw;
    }
    return index;
  }
  void release(std::uint32_t index) {
    known_.release(index);
    value_.release(index);
  }

  /// All of them, to be read by index.
  TreeView::Bricks view() const { return {known_.data(), value_.data()}; }
  /// Bricks that `allocate` would hand out without growing.
  std::size_t spare() const { return value_.spare(); }
  /// Bytes of bricks that were ever handed out.
  std::size_t bytes() const { return known_.bytes() + value_.bytes(); }

 private:
  // Both get the same calls in the same order, and so return the same indices.
  Pool<std::uint64_t> known_;
  Pool<CellValues> value_;
};

/// Number of a cell in its brick.
template <KeyWord W>
constexpr int cell_in_brick(const BasicKey<W>& key) {
  return key.octant(1) * 8 + key.octant(0);
}

/// The cells of an octant of a brick.
constexpr std::uint64_t octant_mask(int octant) {
  return std::uint64_t{0xFF} << (octant * 8);
}

/// Those that are known, a bit for each of the eight.
inline int octant_known(BrickView brick, int octant) {
  return static_cast<int>((brick.known >> (octant * 8)) & 0xFF);
}

}  // namespace pingvox::detail
