#pragma once

namespace pingvox {

/// The standard atmosphere, and sea water below it.
inline constexpr double kSurface_pa = 101'325.0, kPascalsPerMetre = 1025.0 * 9.80665;
/// A higher pressure is not that of air.
inline constexpr double kMaxInAir_pa = 110'000.0;

/// Below the surface of sea water [m], positive down.
constexpr double depth_of_pressure(double pressure_pa) {
  return (pressure_pa - kSurface_pa) / kPascalsPerMetre;
}

}  // namespace pingvox
