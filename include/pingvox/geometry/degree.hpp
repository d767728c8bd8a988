#pragma once

#include <numbers>

namespace pingvox {

/// One degree in radians: `15.0 * kDegree_rad`.
inline constexpr double kDegree_rad = std::numbers::pi / 180.0;

}  // namespace pingvox
