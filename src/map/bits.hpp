#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "pingvox/geometry/key.hpp"

namespace pingvox::detail {

/// Calls f(number) for each bit of a word that is set, from the lowest on.
template <class F>
void for_each_bit(std::uint64_t word, F&& f) {
  for (std::uint64_t left = word; left != 0; left &= left - 1) f(static_cast<std::size_t>(std::countr_zero(left)));
}

/// Index of the highest bit that is set. REQUIRES that one is.
constexpr int highest_bit(std::uint64_t word) {
  return 63 - std::countl_zero(word);
}
constexpr int highest_bit(WideWord word) {
  const auto high = static_cast<std::uint64_t>(word >> 64);
  return high != 0 ? 64 + highest_bit(high) : highest_bit(static_cast<std::uint64_t>(word));
}

/// Bit b set where byte b of a word is not 0.
constexpr std::uint64_t bytes_in_use(std::uint64_t word) {
  word |= word >> 4;
  word |= word >> 2;
  word |= word >> 1;
  // Moves the lowest bit of byte b to bit 56 + b.
  return (word & 0x0101010101010101) * 0x0102040810204080 >> 56;
}

/// How many bits of a word are set. Without an instruction that not every x86-64 has, and the call for lack of it.
constexpr std::uint64_t count_bits(std::uint64_t word) {
  word -= word >> 1 & 0x5555555555555555;
  word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
  word = (word + (word >> 4)) & 0x0F0F0F0F0F0F0F0F;
  return word * 0x0101010101010101 >> 56;
}

}  // namespace pingvox::detail
