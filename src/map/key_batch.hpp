#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "map/tree_order.hpp"
#include "pingvox/geometry/key.hpp"
#include "pingvox/map/brick_tree.hpp"
#include "pingvox/map/scan_window.hpp"

namespace pingvox::detail {

/// Cells of one brick that follow each other in a batch.
struct BrickCells {
  std::uint64_t code = 0;   ///< of the brick, in the tree's order
  std::uint64_t cells = 0;  ///< a bit each
};

/// Sorts by code, stable. Digits that are the same in all codes cost nothing.
inline void sort_by_code(std::vector<BrickCells>& all) {
  std::uint64_t differing = 0;
  for (const BrickCells& one : all) differing |= one.code ^ all.front().code;
  constexpr int kDigit = 11;
  std::vector<BrickCells> sorted(all.size());
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

/// The keys of a batch of updates, gathered by brick in the tree's order.
class KeyBatch {
 public:
  /// Deeper lattices have more bits than a code.
  static constexpr int kMostDepth = 23;

  /// REQUIRES keys of a lattice of kMostDepth levels at most, fewer than 2^32.
  template <KeyWord W>
  explicit KeyBatch(std::span<const BasicKey<W>> keys) {
    // Neighbours in the batch are often neighbours in space: what falls into one brick is one entry.
    BasicKey<W> brick{};
    for (const BasicKey<W>& key : keys) {
      const std::uint64_t bit = std::uint64_t{1} << cell_in_brick(key);
      const BasicKey<W> in{static_cast<W>(key.x >> 2), static_cast<W>(key.y >> 2), static_cast<W>(key.z >> 2)};
      if (!entries_.empty() && in == brick && (entries_.back().cells & bit) == 0) {
        entries_.back().cells |= bit;
        continue;
      }
      brick = in;
      const std::uint64_t code = spread_bits(static_cast<std::uint64_t>(in.x)) |
                                 spread_bits(static_cast<std::uint64_t>(in.y)) << 1 |
                                 spread_bits(static_cast<std::uint64_t>(in.z)) << 2;
      entries_.push_back({code, bit});
    }
    sort_by_code(entries_);
  }

  /// How often each cell of a brick is in the batch.
  struct Cells {
    std::uint64_t once = 0;                      ///< at least once
    std::uint64_t more = 0;                      ///< at least twice
    const std::array<std::uint32_t, 64>& times;  ///< valid where a bit of `more` is set
  };

  /// Calls f(lowest cell of the brick, Cells) for each brick, in the tree's order.
  template <KeyWord W, class F>
  void for_each_brick(F&& f) const {
    std::array<std::uint32_t, 64> times{};
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
      const BasicKey<W> lowest{static_cast<W>(gathered_bits(code) << 2), static_cast<W>(gathered_bits(code >> 1) << 2),
                               static_cast<W>(gathered_bits(code >> 2) << 2)};
      f(lowest, Cells{once, more, times});
    }
  }

 private:
  std::vector<BrickCells> entries_;
};

}  // namespace pingvox::detail
