#pragma once

#include <random>

namespace pingvox::test {

/// One of the numbers low <= number < high, the same with each standard library.
inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace pingvox::test
