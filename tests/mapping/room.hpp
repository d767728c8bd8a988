#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "pingvox/sonar/beam.hpp"

namespace pingvox::test {

/// Beams of a head that turns in a room with walls at 1.5 to 2.8 m.
/// @param bins  of a beam of 3.75 m
inline std::vector<Beam> room(int beams, int beams_per_turn = 200, int bins = 300) {
  std::vector<Beam> heard;
  for (int n = 0; n < beams; ++n) {
    Beam beam{.time_s = 0.04 * n,
              .bearing_rad = 2.0 * std::numbers::pi * (n % beams_per_turn) / beams_per_turn,
              .bin_length_m = 3.75 / bins,
              .intensities = std::vector<std::uint8_t>(static_cast<std::size_t>(bins), 4)};
    const int wall = static_cast<int>(bins * (0.57 + 0.17 * std::sin(0.05 * n)));
    for (int i = wall; i < wall + bins / 50; ++i) {
      beam.intensities[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(120 + n % 100);
    }
    heard.push_back(std::move(beam));
  }
  return heard;
}

}  // namespace pingvox::test
