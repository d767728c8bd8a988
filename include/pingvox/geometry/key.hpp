#pragma once

#include <cassert>
#include <compare>
#include <concepts>
#include <cstdint>
#include <limits>
#include <utility>

namespace pingvox {

/// The widest key component: 128 bits, for lattices deeper than 64 levels.
__extension__ typedef unsigned __int128 WideWord;

/// An unsigned integer that can be one component of a key.
template <class W>
concept KeyWord = std::same_as<W, std::uint8_t> || std::same_as<W, std::uint16_t> || std::same_as<W, std::uint32_t> ||
                  std::same_as<W, std::uint64_t> || std::same_as<W, WideWord>;

/// Levels that a component of type W can address: its bits.
template <KeyWord W>
inline constexpr int kLevelsOf = static_cast<int>(sizeof(W) * 8);

/// The deepest lattice there is.
inline constexpr int kMaxDepth = kLevelsOf<WideWord>;

/// One cell of the finest resolution, or the lowest corner cell of a larger one. All values are valid; on a lattice of
/// depth D only the D lowest bits of a component are used, and the cell whose components are 2^(D-1) has its lowest
/// corner at the map's origin (the layout of OctoMap's keys, Hornung et al. 2013).
template <KeyWord W>
struct BasicKey {
  W x = 0, y = 0, z = 0;

  friend constexpr auto operator<=>(const BasicKey&, const BasicKey&) = default;

  /// Octant (bit 0 x, bit 1 y, bit 2 z) that bit `bit` of the components selects. REQUIRES 0 <= bit < kLevelsOf<W>.
  /// Below the ancestor at depth d of a lattice of depth D that bit is D - 1 - d; the root is depth 0.
  constexpr int octant(int bit) const {
    assert(bit >= 0 && bit < kLevelsOf<W>);
    return static_cast<int>((x >> bit) & 1) | (static_cast<int>((y >> bit) & 1) << 1) |
           (static_cast<int>((z >> bit) & 1) << 2);
  }

  /// The same cell in another width. REQUIRES that its components fit.
  template <KeyWord V>
  constexpr BasicKey<V> as() const {
    assert(static_cast<W>(static_cast<V>(x)) == x && static_cast<W>(static_cast<V>(y)) == y &&
           static_cast<W>(static_cast<V>(z)) == z);
    return {static_cast<V>(x), static_cast<V>(y), static_cast<V>(z)};
  }
};

/// The key of the default lattice of 16 levels: 48 bits (paper, section 5.1).
using Key = BasicKey<std::uint16_t>;
/// A key that fits every lattice.
using WideKey = BasicKey<WideWord>;

/// Calls `f.template operator()<W>()` with the narrowest W that holds `depth` levels: 8, 16, 32, 64 bits, or wide.
/// REQUIRES 1 <= depth <= kMaxDepth.
template <class F>
constexpr decltype(auto) with_key_word(int depth, F&& f) {
  assert(depth >= 1 && depth <= kMaxDepth);
  if (depth <= 8) return std::forward<F>(f).template operator()<std::uint8_t>();
  if (depth <= 16) return std::forward<F>(f).template operator()<std::uint16_t>();
  if (depth <= 32) return std::forward<F>(f).template operator()<std::uint32_t>();
  if (depth <= 64) return std::forward<F>(f).template operator()<std::uint64_t>();
  return std::forward<F>(f).template operator()<WideWord>();
}

}  // namespace pingvox
