#include "pingvox/sim/tank.hpp"

#include <cmath>

#include "base/option_errors.hpp"

namespace pingvox {

OptionErrors TankOptions::errors() const {
  using enum Limits::Ends;
  OptionErrors errors;
  const double half = 0.5 * side_m;
  errors.require("side_m", side_m, {2.0 * std::max(std::abs(sensor_x_m), std::abs(sensor_y_m)), 1000.0, kLowOut});
  errors.require("depth_m", depth_m, {0.0, 1000.0, kLowOut});
  errors.require(std::abs(sensor_x_m) < half, "sensor_x_m", "inside the tank", sensor_x_m);
  errors.require(std::abs(sensor_y_m) < half, "sensor_y_m", "inside the tank", sensor_y_m);
  errors.require(std::isfinite(sensor_yaw_rad), "sensor_yaw_rad", "finite", sensor_yaw_rad);
  errors.require(std::isfinite(floater_bearing_rad), "floater_bearing_rad", "finite", floater_bearing_rad);
  errors.require("floater_radius_m", floater_radius_m, {0.0, 1000.0});
  errors.require(floater_range_m > floater_radius_m && floater_range_m <= 2000.0, "floater_range_m",
                 "greater than its radius and at most 2000", floater_range_m);
  return errors;
}

Result<void> TankOptions::validate() const {
  return errors().result("tank");
}

}  // namespace pingvox
