#pragma once

#include "pingvox/result.hpp"

namespace pingvox {

/// Properties of water that determine the speed of sound.
struct Water {
  double temperature_c = 0.0;  ///< 0..35
  double salinity = 0.0;       ///< practical salinity (about grams of salt in a kilogram), 0..45: 0 fresh, 35 the ocean
  double depth_m = 0.0;        ///< 0..4000

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Speed of sound [m/s] by Coppens (1981), "Simple equations for the speed of sound in Neptunian waters", within about
/// 0.1 m/s of Del Grosso's. REQUIRES valid water.
double sound_speed_m_s(const Water& water);

/// Speed of sound over the one that devices assume, by which their ranges grow. REQUIRES valid water.
double sound_speed_ratio(const Water& water);

}  // namespace pingvox
