#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "geometry/internal/tree_order.hpp"
#include "map/bits.hpp"
#include "map/brick_tree.hpp"
#include "map/pool.hpp"
#include "pingvox/geometry/key.hpp"

namespace pingvox::detail {

/// Cells of one brick that follow each other in a batch.
struct BrickCells {
  std::uint64_t code = 0;   ///< of the brick, in the tree's order
  std::uint64_t cells = 0;  ///< a bit each
};

/// Sorts by code, stable. Digits that are the same in all codes cost nothing.
/// @param sorted  room to work in
inline void sort_by_code(std::vector<BrickCells>& all, std::vector<BrickCells>& sorted) {
  std::uint64_t differing = 0;
  for (const BrickCells& one : all) differing |= one.code ^ all.front().code;
  constexpr int kDigit = 11;
  sorted.resize(all.size());
  std::array<std::uint32_t, (1U << kDigit) + 1> place{};
  for (int shift = 0; shift < 64 && (differing >> shift) != 0; shift += kDigit) {
    constexpr std::uint64_t kMask = (1U << kDigit) - 1;
    if (((differing >> shift) & kMask) == 0) continue;
    place.fill(0);
    for (const BrickCells& one : all) ++place[((one.code >> shift) & kMask) + 1];
    for (std::size_t i = 1; i < place.size(); ++i) place[i] += place[i - 1];
    for (const BrickCells& one : all) sorted[place[(one.code >> shift) & kMask]++] = one;
    all.swap(sorted);
  }
}

/// Counts how often cells are named within a cube of 128^3 cells, a byte each: what batches that are dense in space
/// need no sorting for.
class CountWindow {
 public:
  /// Edge in cells.
  static constexpr unsigned kEdge = 128;

  /// Puts the window around a key. REQUIRES nothing counted in it.
  void open(const BasicKey<std::uint64_t>& around) {
    counts_.grow(std::size_t{kEdge} * kEdge * kEdge);
    const auto base = [](std::uint64_t word) { return (word & ~std::uint64_t{3}) - kEdge / 2; };
    lowest_ = {base(around.x), base(around.y), base(around.z)};
  }

  /// Counts keys, and calls other(key) for those that are outside.
  template <KeyWord W, class F>
  void count(std::span<const BasicKey<W>> keys, F&& other) {
    // By themselves, not as members: to the compiler, a byte that is written may be any part of anything.
    const BasicKey<std::uint64_t> lowest = lowest_;
    std::uint8_t* const counts = all_counts();
    std::uint8_t* const touched = touched_.data();
    for (const BasicKey<W>& key : keys) {
      const auto along = [](W word, std::uint64_t from) { return static_cast<std::uint64_t>(word) - from; };
      const std::uint64_t x = along(key.x, lowest.x), y = along(key.y, lowest.y), z = along(key.z, lowest.z);
      if ((x | y | z) < kEdge) {
        const std::uint32_t place = kSpread[x] | kSpread[y] << 1 | kSpread[z] << 2;
        touched[place / kPage] = 1;
        if (++counts[place] == 0) full_.push_back(place);
        continue;
      }
      other(key.template as<std::uint64_t>());
    }
  }

  /// Counters of the 64 cells of a brick, those of an octant in a word: its first cell's is the lowest byte.
  using Counts = std::array<std::uint64_t, 8>;

  /// What a counter holds when it comes back to 0.
  static constexpr std::uint32_t kFull = 256;

  /// Calls f(lowest cell, Counts, full) for each brick with keys, and empties the window. `full` are cells of the
  /// window, of which the lowest six bits are the number in the brick: each stands there once for kFull keys that its
  /// counter leaves out.
  template <class F>
  void take(F&& f) {
    std::sort(full_.begin(), full_.end());
    std::span<const std::uint32_t> full = full_;  // of this brick, and of those to come
    for (std::size_t page = 0; page < touched_.size(); ++page) {
      if (std::exchange(touched_[page], std::uint8_t{0}) == 0) continue;
      for (std::uint64_t brick = page * (kPage / 64); brick < (page + 1) * (kPage / 64); ++brick) {
        Counts counts;
        std::memcpy(counts.data(), all_counts() + brick * 64, sizeof counts);
        if constexpr (std::endian::native == std::endian::big) {
          for (std::uint64_t& eight : counts) eight = __builtin_bswap64(eight);
        }
        const bool is_full = !full.empty() && full.front() / 64 == brick;
        if (!is_full && std::all_of(counts.begin(), counts.end(), [](std::uint64_t eight) { return eight == 0; })) {
          continue;
        }
        std::memset(all_counts() + brick * 64, 0, sizeof counts);
        const BasicKey<std::uint64_t> at = key_of_code(brick);
        const auto end = std::find_if(full.begin(), full.end(), [&](std::uint32_t cell) { return cell / 64 != brick; });
        const auto in_brick = full.first(static_cast<std::size_t>(end - full.begin()));
        f(BasicKey<std::uint64_t>{lowest_.x + 4 * at.x, lowest_.y + 4 * at.y, lowest_.z + 4 * at.z}, counts, in_brick);
        full = full.subspan(in_brick.size());
      }
    }
    assert(full.empty());
    full_.clear();
  }

 private:
  static constexpr std::array<std::uint32_t, kEdge> kSpread = [] {
    std::array<std::uint32_t, kEdge> spread{};
    for (std::size_t i = 0; i < kEdge; ++i) spread[i] = static_cast<std::uint32_t>(spread_bits(i));
    return spread;
  }();

  static constexpr std::size_t kPage = 4096;  ///< cells

  std::uint8_t* all_counts() { return reinterpret_cast<std::uint8_t*>(counts_.data()); }
  BasicKey<std::uint64_t> lowest_;
  Arena counts_{Arena::Pages::kSmall};  ///< bytes, in the tree's order of their cells
  std::array<std::uint8_t, std::size_t{kEdge} * kEdge * kEdge / kPage> touched_{};  ///< pages
  std::vector<std::uint32_t> full_;  ///< cells, once each time that their counters came back to 0
};

/// The keys of a batch of updates, gathered by brick, about in the tree's order. Its memory is kept for the next batch.
class KeyBatch {
 public:
  /// Deeper lattices have more bits than a code.
  static constexpr int kMaxLevels = 23;
  /// Smaller batches are only sorted.
  static constexpr std::size_t kWorthAWindow = 16'384;

  /// REQUIRES keys of a lattice of kMaxLevels levels at most, fewer than 2^32.
  template <KeyWord W>
  void gather(std::span<const BasicKey<W>> keys) {
    assert(entries_.empty());
    if (keys.size() < kWorthAWindow) {
      for (const BasicKey<W>& key : keys) add(key.template as<std::uint64_t>());
    } else {
      window_.open(middle_of(keys));
      window_.count(keys, [this](const BasicKey<std::uint64_t>& key) { add(key); });
    }
    add_entry();
    if (!entries_.empty()) sort_by_code(entries_, room_);
  }

  /// How often each cell of a brick is in the batch.
  struct Cells {
    std::uint64_t once = 0;                      ///< at least once
    std::uint64_t more = 0;                      ///< at least twice
    const std::array<std::uint32_t, 64>& times;  ///< valid where a bit of `more` is set
  };

  /// Calls f(lowest cell of the brick, Cells) for each brick, and empties the batch. A brick may come twice.
  template <class F>
  void take(F&& f) {
    std::array<std::uint32_t, 64> times{};
    window_.take([&](const BasicKey<std::uint64_t>& lowest, const CountWindow::Counts& counts,
                     std::span<const std::uint32_t> full) {
      std::uint64_t once = 0, more = 0;
      for (std::size_t octant = 0; octant < 8; ++octant) {
        once |= bytes_in_use(counts[octant]) << (8 * octant);
        more |= bytes_in_use(counts[octant] & 0xFEFEFEFEFEFEFEFE) << (8 * octant);
      }
      if (more != 0 || !full.empty()) {
        for (std::size_t cell = 0; cell < 64; ++cell) {
          times[cell] = static_cast<std::uint8_t>(counts[cell / 8] >> (8 * (cell % 8)));
        }
      }
      for (const std::uint32_t cell : full) {
        times[cell % 64] += CountWindow::kFull;
        once |= std::uint64_t{1} << (cell % 64);
        more |= std::uint64_t{1} << (cell % 64);
      }
      f(lowest, Cells{once, more, times});
    });
    for (std::size_t i = 0; i < entries_.size();) {
      const std::uint64_t code = entries_[i].code;
      std::uint64_t once = 0, more = 0;
      for (; i < entries_.size() && entries_[i].code == code; ++i) {
        for (std::uint64_t again = entries_[i].cells & once; again != 0; again &= again - 1) {
          const auto cell = static_cast<std::size_t>(std::countr_zero(again));
          times[cell] = ((more >> cell) & 1) != 0 ? times[cell] + 1 : 2;
          more |= std::uint64_t{1} << cell;
        }
        once |= entries_[i].cells;
      }
      const BasicKey<std::uint64_t> brick = key_of_code(code);
      f(BasicKey<std::uint64_t>{brick.x << 2, brick.y << 2, brick.z << 2}, Cells{once, more, times});
    }
    entries_.clear();
  }

 private:
  /// Of the box around some of the keys.
  template <KeyWord W>
  static BasicKey<std::uint64_t> middle_of(std::span<const BasicKey<W>> keys) {
    constexpr std::size_t kLooked = 64;
    auto low = keys.front().template as<std::uint64_t>(), high = low;
    for (std::size_t i = 0; i < keys.size(); i += keys.size() / kLooked) {
      const auto key = keys[i].template as<std::uint64_t>();
      low = {std::min(low.x, key.x), std::min(low.y, key.y), std::min(low.z, key.z)};
      high = {std::max(high.x, key.x), std::max(high.y, key.y), std::max(high.z, key.z)};
    }
    return {(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
  }

  /// Neighbours in the batch are often neighbours in space: what falls into one brick is one entry.
  void add(const BasicKey<std::uint64_t>& key) {
    const std::uint64_t bit = std::uint64_t{1} << cell_in_brick(key);
    const BasicKey<std::uint64_t> brick{key.x >> 2, key.y >> 2, key.z >> 2};
    if (brick != brick_ || (cells_ & bit) != 0) {
      add_entry();
      brick_ = brick;
    }
    cells_ |= bit;
  }

  void add_entry() {
    if (cells_ == 0) return;
    entries_.push_back({code_of(brick_), cells_});
    cells_ = 0;
  }

  CountWindow window_;
  BasicKey<std::uint64_t> brick_;  ///< of the entry in the making
  std::uint64_t cells_ = 0;
  std::vector<BrickCells> entries_, room_;
};

}  // namespace pingvox::detail
