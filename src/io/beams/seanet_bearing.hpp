#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string_view>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// What the status of a head says that is wrong with its beam; nullopt: nothing.
inline std::optional<std::string_view> seanet_fault(std::uint64_t status) {
  constexpr std::uint64_t kNoPower = 1, kLostStep = 2;
  if ((status & kNoPower) != 0) return "the head had lost its power";
  if ((status & kLostStep) != 0) return "the head's motor had lost its step";
  return std::nullopt;
}

/// Bearing in the sensor frame from 1/16 gradians, clockwise with 3200 ahead; nullopt: more than a turn.
inline std::optional<double> seanet_bearing_rad(std::uint64_t bearing) {
  constexpr double kTurn = 6400.0, kAhead = 3200.0;
  if (bearing > 6400) return std::nullopt;
  return wrap_bearing((kAhead - static_cast<double>(bearing)) * (2.0 * std::numbers::pi / kTurn));
}

/// Bin length from the range scale: low 14 bits in tenths of a unit, high 2 bits the unit. 1 m if there are no bins.
inline double seanet_bin_length_m(std::uint16_t range_scale, std::size_t bins) {
  constexpr std::array kUnits_m = {1.0, 0.3048, 1.8288, 0.9144};
  const double range_m = 0.1 * (range_scale & 0x3fff) * kUnits_m[range_scale >> 14];
  return bins > 0 ? range_m / static_cast<double>(bins) : 1.0;
}

}  // namespace pingvox
