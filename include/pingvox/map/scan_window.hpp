#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "pingvox/map/pool.hpp"

namespace pingvox::detail {

struct FanRoom;

/// Scratch for tracers of many rays: two dense bit masks (missed, hit) over a cube of cells, in the tree's order, so
/// that a mark is one bit in one word at a known place. Memory that no ray comes near is never touched. Empty between
/// scans; a copy is a new empty one.
class ScanWindow {
 public:
  /// Up to 2048 cells along each axis.
  static constexpr int kMostBits = 11;
  /// Cells of a page: what ScanUpdate keeps together.
  static constexpr int kPageCellBits = 12;
  /// Where marks of a page may be.
  static constexpr std::uint8_t kInMask = 1, kInLayer = 2;

  ScanWindow() = default;
  ScanWindow(const ScanWindow&) : ScanWindow() {}
  ScanWindow(ScanWindow&&) noexcept = default;
  ScanWindow& operator=(const ScanWindow& other) {
    if (this != &other) *this = ScanWindow();
    return *this;
  }
  ScanWindow& operator=(ScanWindow&&) noexcept = default;
  ~ScanWindow() = default;

  /// Makes room for a cube of 2^bits cells along each axis. Throws std::bad_alloc. REQUIRES 4 <= bits <= kMostBits, and
  /// that it is empty.
  void open(int bits);

  int bits() const { return bits_; }
  /// A bit a cell: cell c is bit c % 64 of word c / 64.
  std::uint64_t* missed() { return reinterpret_cast<std::uint64_t*>(missed_.data()); }
  std::uint64_t* hit() { return reinterpret_cast<std::uint64_t*>(hit_.data()); }
  /// The same for a tracer's own use: it leaves it empty.
  std::uint64_t* asked() { return reinterpret_cast<std::uint64_t*>(asked_.data()); }
  /// Misses in one layer of cells, besides those above: what a flat fan marks stays close together here. Cells are in
  /// the tree's order without z: 8 by 8 of them are a word, four words a page's.
  std::uint64_t* layer() { return reinterpret_cast<std::uint64_t*>(layer_.data()); }
  std::size_t layer_pages() const { return std::size_t{1} << (2 * (bits_ - kPageCellBits / 3)); }
  /// The bits of z in places of its cells; nothing while it is empty.
  std::optional<std::uint64_t>& layer_z() { return layer_z_; }
  /// Adds kInLayer to the bytes of pages with marks in the layer.
  void touch_layer();
  /// A byte a page, kInMask where either may have a mark; pages are numbered like cells.
  std::uint8_t* touched() { return reinterpret_cast<std::uint8_t*>(touched_.data()); }
  /// The same for pages where some may be hit: few of those that rays cross.
  std::uint8_t* with_hits() { return reinterpret_cast<std::uint8_t*>(with_hits_.data()); }
  std::size_t pages() const { return std::size_t{1} << (3 * bits_ - kPageCellBits); }
  /// What DenseFan works in, kept from scan to scan: a megabyte that is given back and asked for again costs as much as
  /// filling it.
  FanRoom& fan_room();

 private:
  int bits_ = 0;
  Arena missed_{Arena::Pages::kSmall}, hit_{Arena::Pages::kSmall}, asked_{Arena::Pages::kSmall},
      layer_{Arena::Pages::kSmall}, touched_{Arena::Pages::kSmall}, with_hits_{Arena::Pages::kSmall};
  std::optional<std::uint64_t> layer_z_;
  std::shared_ptr<FanRoom> fan_room_;  ///< made when it is asked for
};

/// Sets the bit of a cell in one of a window's masks, and the byte of its page. There is no branch: whether a ray is
/// the first one in a cell cannot be foreseen.
inline __attribute__((always_inline)) void mark_place(std::uint64_t place, std::uint64_t* mask, std::uint8_t* touched) {
  mask[place / 64] |= std::uint64_t{1} << (place % 64);
  touched[place >> ScanWindow::kPageCellBits] = 1;
}

/// Marks a cell as hit. Most that rays end in are marked already. @return whether it was not marked before
inline bool mark_hit(std::uint64_t place, ScanWindow& window) {
  if ((window.hit()[place / 64] >> (place % 64) & 1) != 0) return false;
  mark_place(place, window.hit(), window.touched());
  window.with_hits()[place >> ScanWindow::kPageCellBits] = 1;
  return true;
}

/// The same for many cells. There is no branch for each: which of them are new cannot be foreseen.
/// @param fresh  its first ones become those that were not marked before
/// @return how many
/// REQUIRES as much room in `fresh` as there are places; they may be the same
inline std::size_t mark_hits(std::span<const std::uint64_t> places, ScanWindow& window, std::uint64_t* fresh) {
  std::size_t count = 0;
  for (const std::uint64_t place : places) {
    std::uint64_t& word = window.hit()[place / 64];
    const std::uint64_t before = word;
    word |= std::uint64_t{1} << (place % 64);
    fresh[count] = place;
    count += ~before >> (place % 64) & 1;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t page = fresh[i] >> ScanWindow::kPageCellBits;
    window.touched()[page] = 1;
    window.with_hits()[page] = 1;
  }
  return count;
}

/// Calls f(page, byte) for each page that is touched, and clears its byte.
template <class F>
void take_touched(ScanWindow& window, F&& f) {
  constexpr std::size_t kTogether = 8;
  std::uint8_t* const touched = window.touched();
  for (std::size_t first = 0; first < window.pages(); first += kTogether) {
    std::uint64_t some;
    std::memcpy(&some, touched + first, sizeof some);
    if (some == 0) continue;
    for (std::size_t page = first; page < first + kTogether; ++page) {
      if (touched[page] != 0) f(page, std::exchange(touched[page], std::uint8_t{0}));
    }
  }
}

}  // namespace pingvox::detail
