#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace pingvox {

/// Median absolute deviation to standard deviation, of normal noise.
inline constexpr double kMadToDeviation = 1.4826;
/// The middle one of the numbers in order, of an even count the upper one. REQUIRES at least one number.
inline double median(std::vector<double> numbers) {
  assert(!numbers.empty());
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

}  // namespace pingvox
