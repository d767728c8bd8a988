#pragma once

#include <cstdint>
#include <limits>

/// Counts of cells, which stay at the largest number when they would pass it: a leaf near the root of a deep lattice
/// stands for more cells than 64 bits can count.
namespace pingvox::detail {

/// Adds to a sum, saturated.
constexpr void add_saturated(std::uint64_t& sum, std::uint64_t n) {
  constexpr std::uint64_t kMax = std::numeric_limits<std::uint64_t>::max();
  sum = n > kMax - sum ? kMax : sum + n;
}

/// Cells of the finest resolution in a node that is so many levels high, saturated.
constexpr std::uint64_t cells_in_node(int levels) {
  return levels > 21 ? std::numeric_limits<std::uint64_t>::max() : std::uint64_t{1} << (3 * levels);
}

}  // namespace pingvox::detail
