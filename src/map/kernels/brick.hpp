#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "map/kernels/lanes.hpp"
#include "pingvox/map/brick.hpp"
#include "pingvox/map/log_odds.hpp"

/// Loops over the 64 values of a brick, as many at a time as the machine's vectors hold. Each gives, to the last bit,
/// what the plain loop in its comment gives (tests/map/brick_kernels_test.cpp).
namespace pingvox::detail {

/// for each cell of `cells`: value = updated_by(value, evidence, clamp). REQUIRES evidence != 0 and unknown cells to be
/// 0.
/// @return whether a value changed
bool add_alike(BrickRef brick, std::uint64_t cells, float evidence, const Clamp& clamp, Lanes lanes = widest_lanes());

/// for each known cell: highest = max(highest, value)
float highest_of(BrickView brick, Lanes lanes = widest_lanes());

/// for each cell: value == value[0]
bool are_equal(BrickView brick, Lanes lanes = widest_lanes());

/// for each cell, known or not: its bit set where value >= threshold
std::uint64_t cells_from(BrickView brick, float threshold, Lanes lanes = widest_lanes());

/// Four values at a time, for what is too short for more.
using Four = float __attribute__((vector_size(16)));
using FourMasks = std::int32_t __attribute__((vector_size(16)));

inline Four four_at(BrickView brick, std::size_t first) {
  Four values;
  std::memcpy(&values, brick.value.data() + first, sizeof values);
  return values;
}

/// All bits of a lane set where a bit of `cells`, shifted down to the first of four, is set.
inline FourMasks lanes_of(std::uint64_t cells) {
  constexpr FourMasks kBits{1, 2, 4, 8};
  return (kBits & static_cast<std::int32_t>(cells & 0xF)) != 0;
}

/// for each octant o: bit o set where a cell's value is not that of the octant's first
inline unsigned octants_that_differ(BrickView brick) {
  FourMasks different{};
  for (std::size_t o = 0; o < 8; ++o) {
    const float first = brick.value[o * 8];
    different |= ((four_at(brick, o * 8) != first) | (four_at(brick, o * 8 + 4) != first)) & (1 << o);
  }
  return static_cast<unsigned>(different[0] | different[1] | different[2] | different[3]);
}

/// for each cell of `a`: value = value_a, for each of `b`: value = value_b, else 0. REQUIRES a and b to be disjoint.
inline void fill(BrickRef brick, std::uint64_t a, float value_a, std::uint64_t b, float value_b) {
  for (std::size_t first = 0; first < 64; first += 4) {
    const Four zero{};
    const Four other = lanes_of(b >> first) != 0 ? zero + value_b : zero;
    const Four value = lanes_of(a >> first) != 0 ? zero + value_a : other;
    std::memcpy(brick.value.data() + first, &value, sizeof value);
  }
}

/// for each byte b of a word: bit b set where all bits of the byte are
inline unsigned full_bytes(std::uint64_t word) {
  word &= word >> 4;
  word &= word >> 2;
  word &= word >> 1;
  // Moves the lowest bit of byte b to bit 56 + b.
  return static_cast<unsigned>(((word & 0x0101010101010101) * 0x0102040810204080) >> 56);
}

/// for each bit b of a byte: all bits of byte b set where it is
inline std::uint64_t cells_of_octants(unsigned octants) {
  const std::uint64_t one_bit_each = std::uint64_t{octants & 0xFF} * 0x0101010101010101 & 0x8040201008040201;
  // Moves whichever bit of a byte is set to its lowest; no byte carries into the next.
  return ((one_bit_each + 0x7F7F7F7F7F7F7F7F) >> 7 & 0x0101010101010101) * 0xFF;
}

}  // namespace pingvox::detail
