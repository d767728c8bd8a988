#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "map/brick.hpp"
#include "pingvox/map/log_odds.hpp"

/// Loops over the 64 values of a brick, four at a time, which each x86-64 and ARM64 machine can. Each gives, to the
/// last bit, what the plain loop in its comment gives (tests/map/brick_loops_test.cpp).
namespace pingvox::detail {

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

inline bool any_of(FourMasks lanes) {
  return (lanes[0] | lanes[1] | lanes[2] | lanes[3]) != 0;
}

/// for each cell of `cells`: value = add_evidence(value, evidence, clamp). REQUIRES evidence != 0 and unknown cells to
/// be 0.
/// @return whether a value changed
inline bool add_alike(BrickRef brick, std::uint64_t cells, float evidence, const Clamp& clamp) {
  const float lowest = clamp.lowest.value(), highest = clamp.highest.value();
  const bool is_hit = evidence > 0.0F;
  FourMasks changed{};
  for (std::size_t first = 0; first < 64; first += 4) {
    const std::uint64_t some = cells >> first;
    if ((some & 0xF) == 0) continue;
    const Four before = four_at(brick, first);
    const Four sum = before + evidence;
    const Four from_below = sum < lowest ? Four{} + lowest : sum;
    const Four clamped = from_below > highest ? Four{} + highest : from_below;
    // What is at the clamp that the evidence leads to, or was set beyond it, stays.
    const FourMasks moves = is_hit ? before < highest : before > lowest;
    const Four after = (lanes_of(some) & moves) != 0 ? clamped : before;
    changed |= after != before;
    std::memcpy(brick.value.data() + first, &after, sizeof after);
  }
  return any_of(changed);
}

/// for each known cell: highest = max(highest, value)
inline float highest_of(BrickView brick) {
  Four highest = Four{} + std::numeric_limits<float>::lowest();
  for (std::size_t first = 0; first < 64; first += 4) {
    if ((brick.known >> first & 0xF) == 0) continue;  // as half of each brick in a flat map
    const Four value = four_at(brick, first);
    highest = (lanes_of(brick.known >> first) & (value > highest)) != 0 ? value : highest;
  }
  const float one = highest[0] < highest[1] ? highest[1] : highest[0];
  const float other = highest[2] < highest[3] ? highest[3] : highest[2];
  return one < other ? other : one;
}

/// for each cell: value == value[0]
inline bool are_equal(BrickView brick) {
  for (std::size_t first = 0; first < 64; first += 4) {
    if (any_of(four_at(brick, first) != brick.value[0])) return false;
  }
  return true;
}

/// for each cell, known or not: its bit set where value >= threshold
inline std::uint64_t cells_from(BrickView brick, float threshold) {
  std::uint64_t cells = 0;
  for (std::size_t half = 0; half < 64; half += 32) {
    FourMasks some{}, bits{1, 2, 4, 8};
    for (std::size_t first = 0; first < 32; first += 4) {
      some |= (four_at(brick, half + first) >= threshold) & bits;
      bits <<= 4;
    }
    cells |= std::uint64_t{static_cast<std::uint32_t>(some[0] | some[1] | some[2] | some[3])} << half;
  }
  return cells;
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
