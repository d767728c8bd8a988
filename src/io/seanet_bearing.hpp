#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// A bearing in 1/16 gradian, clockwise with 3200 ahead, in the sensor's frame; nullopt: more than a turn.
inline std::optional<double> seanet_bearing_rad(std::uint64_t bearing) {
  constexpr double kTurn = 6400.0, kAhead = 3200.0;
  if (bearing > 6400) return std::nullopt;
  return wrapped_bearing((kAhead - static_cast<double>(bearing)) * (2.0 * std::numbers::pi / kTurn));
}

/// A bin's length by the range scale: its low 14 bits are tenths of a unit, the other two say which one. 1 m, which is
/// as good as any other, when there are no bins.
inline double seanet_bin_length_m(std::uint16_t range_scale, std::size_t bins) {
  constexpr std::array kUnits_m = {1.0, 0.3048, 1.8288, 0.9144};
  const double range_m = 0.1 * (range_scale & 0x3fff) * kUnits_m[range_scale >> 14];
  return bins > 0 ? range_m / static_cast<double>(bins) : 1.0;
}

}  // namespace pingvox
