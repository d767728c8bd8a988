#pragma once

#include "pingvox/geometry/key.hpp"

namespace pingvox::detail {

/// Whether the highest bit of a is below the highest bit of b.
constexpr bool is_lower_in_highest_bit(WideWord a, WideWord b) {
  return a < b && a < (a ^ b);
}

/// The tree's order: the axis that differs in the highest bit decides; in a tie z before y before x.
constexpr bool is_before(const WideKey& a, const WideKey& b) {
  WideWord most = a.z ^ b.z;
  bool before = a.z < b.z;
  if (is_lower_in_highest_bit(most, a.y ^ b.y)) {
    most = a.y ^ b.y;
    before = a.y < b.y;
  }
  if (is_lower_in_highest_bit(most, a.x ^ b.x)) before = a.x < b.x;
  return before;
}

}  // namespace pingvox::detail
