#pragma once

#include <cmath>
#include <cstdint>

namespace pingvox {

/// Random numbers that are the same on every machine: integers and square roots only, which IEEE 754 rounds exactly.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// SplitMix64 (Steele, Lea, Flood 2014): the next 64 random bits.
  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  /// At least 0 and less than 1.
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }

  /// Approximately standard normal: the sum of twelve uniform numbers of 16 bits.
  double normal() {
    std::int64_t sum = 0;
    for (int word = 0; word < 3; ++word) {
      const std::uint64_t all = bits();
      for (unsigned part = 0; part < 64; part += 16) sum += static_cast<std::int64_t>((all >> part) & 0xffffU);
    }
    return static_cast<double>(sum - std::int64_t{6} * 65535) / 65536.0;
  }

  /// Rayleigh-distributed with mean 1: the amplitude of many small echoes with random phases.
  double rayleigh() {
    const double a = normal();
    const double b = normal();
    return 0.7978845608028654 * std::sqrt(a * a + b * b);  // sqrt(2 / pi)
  }

 private:
  std::uint64_t state_;
};

}  // namespace pingvox
