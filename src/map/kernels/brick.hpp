#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "pingvox/map/brick_tree.hpp"

/// Loops over the 64 values of a brick, four at a time: the compiler's vectors of 16 bytes, which each x86-64 and ARM64
/// machine has. Each gives, to the last bit, what the plain loop in its comment gives
/// (tests/map/brick_kernels_test.cpp).
namespace pingvox::detail {

using Four = float __attribute__((vector_size(16)));
using FourMasks = std::int32_t __attribute__((vector_size(16)));

inline Four four_at(const Brick& brick, std::size_t first) {
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

/// for each cell of `cells`: value = updated_by(value, evidence, clamp). REQUIRES evidence != 0 and unknown cells to be
/// 0.
/// @return whether a value changed
inline bool add_alike(Brick& brick, std::uint64_t cells, float evidence, const Clamp& clamp) {
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
inline float highest_of(const Brick& brick) {
  Four highest = Four{} + std::numeric_limits<float>::lowest();
  for (std::size_t first = 0; first < 64; first += 4) {
    const Four value = four_at(brick, first);
    highest = (lanes_of(brick.known >> first) & (value > highest)) != 0 ? value : highest;
  }
  const float a = highest[0] > highest[1] ? highest[0] : highest[1];
  const float b = highest[2] > highest[3] ? highest[2] : highest[3];
  return a > b ? a : b;
}

/// for each cell: value == value[0]
inline bool are_equal(const Brick& brick) {
  FourMasks different{};
  for (std::size_t first = 0; first < 64; first += 4) different |= four_at(brick, first) != brick.value[0];
  return !any_of(different);
}

}  // namespace pingvox::detail
