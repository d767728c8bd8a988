#pragma once

#include <cmath>
#include <cstdint>

#include "pingvox/viewer/picture.hpp"

namespace pingvox {

inline constexpr Rgb kPaper{255, 255, 255}, kInk{40, 44, 52}, kPaleInk{214, 218, 224};

/// Linear interpolation: `share` 0 is a, 1 is b.
inline Rgb mix(Rgb a, Rgb b, double share) {
  const auto part = [&](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + (to - from) * share));
  };
  return {part(a.red, b.red), part(a.green, b.green), part(a.blue, b.blue)};
}

}  // namespace pingvox
