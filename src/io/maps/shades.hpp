#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace pingvox {

/// From dark blue to yellow, as viridis of Matplotlib.
/// @param share  0 to 1
/// @return red, green and blue of sRGB, 0 to 1
inline std::array<double, 3> shade_at(double share) {
  constexpr std::array<std::array<double, 3>, 5> kStops = {
      {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
  constexpr double kWhite = 255.0;
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1.0);
  const std::size_t stop = std::min<std::size_t>(static_cast<std::size_t>(at), kStops.size() - 2);
  const double part = at - static_cast<double>(stop);
  std::array<double, 3> colour{};
  for (std::size_t channel = 0; channel < colour.size(); ++channel) {
    colour[channel] = (kStops[stop][channel] + part * (kStops[stop + 1][channel] - kStops[stop][channel])) / kWhite;
  }
  return colour;
}

}  // namespace pingvox
