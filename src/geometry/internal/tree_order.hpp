#pragma once

#include <cstdint>

#include "pingvox/geometry/key.hpp"

namespace pingvox::detail {

/// A number of up to 21 bits with two zero bits between its bits.
constexpr std::uint64_t spread_bits(std::uint64_t word) {
  word = (word | word << 32) & 0x1F00000000FFFFU;
  word = (word | word << 16) & 0x1F0000FF0000FFU;
  word = (word | word << 8) & 0x100F00F00F00F00FU;
  word = (word | word << 4) & 0x10C30C30C30C30C3U;
  return (word | word << 2) & 0x1249249249249249U;
}

/// Takes every third bit, from the lowest on.
constexpr std::uint64_t gather_bits(std::uint64_t code) {
  code &= 0x1249249249249249U;
  code = (code | code >> 2) & 0x10C30C30C30C30C3U;
  code = (code | code >> 4) & 0x100F00F00F00F00FU;
  code = (code | code >> 8) & 0x1F0000FF0000FFU;
  code = (code | code >> 16) & 0x1F00000000FFFFU;
  return (code | code >> 32) & 0x1FFFFFU;
}

/// The number of a key in the tree's order: three bits a level, its octant. REQUIRES components of up to 21 bits.
template <KeyWord W>
constexpr std::uint64_t code_of(const BasicKey<W>& key) {
  const auto spread = [](W word) { return spread_bits(static_cast<std::uint64_t>(word)); };
  return spread(key.x) | spread(key.y) << 1 | spread(key.z) << 2;
}

/// The key with that number.
constexpr BasicKey<std::uint64_t> key_of_code(std::uint64_t code) {
  return {gather_bits(code), gather_bits(code >> 1), gather_bits(code >> 2)};
}

}  // namespace pingvox::detail
