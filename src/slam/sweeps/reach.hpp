#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pingvox {

/// The range that nine of ten ranges are within [m]; 0 without ranges.
inline double reach_of(std::vector<double> ranges_m) {
  if (ranges_m.empty()) return 0.0;
  const auto nine_of_ten = ranges_m.begin() + static_cast<std::ptrdiff_t>(ranges_m.size() * 9 / 10);
  std::ranges::nth_element(ranges_m, nine_of_ten);
  return *nine_of_ten;
}

}  // namespace pingvox
