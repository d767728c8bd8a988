#include "pingvox/sonar/sound_speed.hpp"

#include <fmt/core.h>

#include <cassert>
#include <string>
#include <string_view>

#include "pingvox/sonar/device_profile.hpp"

namespace pingvox {

Result<void> Water::validate() const {
  std::string bad;
  const auto check = [&bad](std::string_view name, double value, double highest) {
    if (value >= 0.0 && value <= highest) return;
    bad += fmt::format("{} {} must be in 0..{}, is {}", bad.empty() ? "" : ";", name, highest, value);
  };
  check("temperature [degrees C]", temperature_c, 35.0);
  check("salinity", salinity, 45.0);
  check("depth [m]", depth_m, 4000.0);
  if (bad.empty()) return {};
  return fail(Error::Code::kBadOption, "water:" + bad);
}

double sound_speed_m_s(const Water& water) {
  assert(water.validate());
  const double t = water.temperature_c / 10.0, d = water.depth_m / 1000.0, s = water.salinity - 35.0;
  const double at_surface = 1449.05 + t * (45.7 + t * (-5.21 + t * 0.23)) + (1.333 + t * (-0.126 + t * 0.009)) * s;
  return at_surface + (16.23 + 0.253 * t) * d + (0.213 - 0.1 * t) * d * d + (0.016 + 0.0002 * s) * s * t * d;
}

double sound_speed_ratio(const Water& water) {
  return sound_speed_m_s(water) / kAssumedSoundSpeed_m_s;
}

}  // namespace pingvox
