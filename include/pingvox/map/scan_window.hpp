#pragma once

#include <array>
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

/// A number of up to 11 bits with two zero bits between its bits: x, y << 1 and z << 2 of a cell make its place in the
/// tree's order.
constexpr std::uint64_t spread_bits(std::uint64_t word) {
  word = (word | word << 32) & 0x1F00000000FFFFU;
  word = (word | word << 16) & 0x1F0000FF0000FFU;
  word = (word | word << 8) & 0x100F00F00F00F00FU;
  word = (word | word << 4) & 0x10C30C30C30C30C3U;
  return (word | word << 2) & 0x1249249249249249U;
}

/// Takes every third bit.
constexpr std::uint64_t gathered_bits(std::uint64_t code) {
  code &= 0x1249249249249249U;
  code = (code | code >> 2) & 0x10C30C30C30C30C3U;
  code = (code | code >> 4) & 0x100F00F00F00F00FU;
  code = (code | code >> 8) & 0x1F0000FF0000FFU;
  code = (code | code >> 16) & 0x1F00000000FFFFU;
  return (code | code >> 32) & 0x1FFFFFU;
}

}  // namespace pingvox::detail
