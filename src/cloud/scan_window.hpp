#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

namespace pingvox::detail {

/// Bits of each axis in a place: cells are numbered in the tree's order, three bits a level, x lowest.
inline constexpr std::array<std::uint64_t, 3> kPlaceBits{0x1249249249249249U, 0x1249249249249249U << 1,
                                                         0x1249249249249249U << 2};

/// Returns memory to the system.
struct Unmap {
  std::size_t bytes = 0;
  void operator()(void* memory) const;
};

/// Two dense bit masks (missed, hit) over a cube of cells, so that a mark is one bit of one word. Memory that no ray
/// comes near is never touched. Empty between scans.
class ScanWindow {
 public:
  /// Up to 2048 cells along each axis.
  static constexpr int kMaxBits = 11;
  /// Cells of a page of ScanUpdate: 16^3.
  static constexpr int kPageCellBits = 12;

  /// Makes room for a cube of 2^bits cells along each axis. Throws std::bad_alloc. REQUIRES 4 <= bits <= kMaxBits, and
  /// that it is empty.
  void open(int bits);
  /// Returns all memory: for when it cannot be emptied.
  void drop() { *this = ScanWindow(); }

  /// Cell c is bit c % 64 of word c / 64.
  std::uint64_t* missed() { return missed_; }
  std::uint64_t* hit() { return hit_; }
  /// A byte a page, not 0 where some of its cells may be marked.
  std::uint8_t* touched() { return touched_; }
  /// The same for hits alone: few of the pages that rays cross have some.
  std::uint8_t* with_hits() { return with_hits_; }
  std::size_t pages() const { return std::size_t{1} << (3 * bits_ - kPageCellBits); }

  /// Marks a cell as hit. @return whether it was not marked before
  bool mark_hit(std::uint64_t place) {
    std::uint64_t& word = hit_[place / 64];
    const std::uint64_t bit = std::uint64_t{1} << (place % 64);
    if ((word & bit) != 0) return false;
    word |= bit;
    touched_[place >> kPageCellBits] = 1;
    with_hits_[place >> kPageCellBits] = 1;
    return true;
  }

  /// Takes back all hits among these places. REQUIRES that nothing else is marked
  void clear_hits(std::span<const std::uint64_t> places) {
    for (const std::uint64_t place : places) {
      hit_[place / 64] = 0;
      touched_[place >> kPageCellBits] = 0;
      with_hits_[place >> kPageCellBits] = 0;
    }
  }

  /// Calls f(page, has_hits) for each page that is touched, and forgets that it is.
  template <class F>
  void take_touched(F&& f) {
    constexpr std::size_t kTogether = 8;
    for (std::size_t first = 0; first < pages(); first += kTogether) {
      std::uint64_t some;
      std::memcpy(&some, touched() + first, sizeof some);
      if (some == 0) continue;
      for (std::size_t page = first; page < first + kTogether && page < pages(); ++page) {
        if (std::exchange(touched_[page], std::uint8_t{0}) == 0) continue;
        f(page, std::exchange(with_hits_[page], std::uint8_t{0}) != 0);
      }
    }
  }

 private:
  int bits_ = 0;
  int room_bits_ = 0;  ///< what there is memory for
  /// Of all four, from the system and not from a heap: pages are zero, and take memory once they are written.
  std::unique_ptr<void, Unmap> memory_;
  std::uint64_t *missed_ = nullptr, *hit_ = nullptr;
  std::uint8_t *touched_ = nullptr, *with_hits_ = nullptr;
};

}  // namespace pingvox::detail
