#pragma once

#include <cstddef>
#include <cstdint>

#include "pingvox/map/pool.hpp"

namespace pingvox::detail {

/// Scratch for tracers of many rays: two dense bit masks (missed, hit) over a cube of cells, in the tree's order, so
/// that a mark is one bit in one word at a known place. Memory that no ray comes near is never touched. Empty between
/// scans; a copy is a new empty one.
class ScanWindow {
 public:
  /// Up to 2048 cells along each axis.
  static constexpr int kMostBits = 11;
  /// Cells of a page: what ScanUpdate keeps together.
  static constexpr int kPageCellBits = 12;

  ScanWindow() = default;
  ScanWindow(const ScanWindow&) : ScanWindow() {}
  ScanWindow(ScanWindow&&) noexcept = default;
  ScanWindow& operator=(const ScanWindow&) { return *this = ScanWindow(); }
  ScanWindow& operator=(ScanWindow&&) noexcept = default;
  ~ScanWindow() = default;

  /// Makes room for a cube of 2^bits cells along each axis. Throws std::bad_alloc. REQUIRES 4 <= bits <= kMostBits, and
  /// that it is empty.
  void open(int bits);

  int bits() const { return bits_; }
  /// A bit a cell: cell c is bit c % 64 of word c / 64.
  std::uint64_t* missed() { return reinterpret_cast<std::uint64_t*>(missed_.data()); }
  std::uint64_t* hit() { return reinterpret_cast<std::uint64_t*>(hit_.data()); }
  /// A bit a page in which either has a mark.
  std::uint64_t* touched() { return reinterpret_cast<std::uint64_t*>(touched_.data()); }
  std::size_t touched_words() const { return (std::size_t{1} << (3 * bits_ - kPageCellBits)) / 64 + 1; }

 private:
  int bits_ = 0;
  Arena missed_{Arena::Pages::kSmall}, hit_{Arena::Pages::kSmall}, touched_{Arena::Pages::kSmall};
};

/// Sets the bit of a cell in one of a window's masks, and that of its page. @return whether it was not set before
inline __attribute__((always_inline)) bool mark_place(std::uint64_t place, std::uint64_t* mask,
                                                      std::uint64_t* touched) {
  std::uint64_t& word = mask[place / 64];
  const std::uint64_t bit = std::uint64_t{1} << (place % 64);
  // Most cells are crossed by many rays: reading is cheaper than writing the same again.
  if ((word & bit) != 0) return false;
  word |= bit;
  const std::uint64_t page = place >> ScanWindow::kPageCellBits;
  touched[page / 64] |= std::uint64_t{1} << (page % 64);
  return true;
}

}  // namespace pingvox::detail
