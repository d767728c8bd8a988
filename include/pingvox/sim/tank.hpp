#pragma once

#include "pingvox/result.hpp"

namespace pingvox {

class OptionErrors;

/// A square tank with vertical walls and a floater (a vertical cylinder). The map frame is that of a still sensor in
/// it. Defaults: similar to the tank of the paper's recording.
struct TankOptions {
  double side_m = 4.5;               ///< of the square, > 0
  double depth_m = 4.0;              ///< of the walls, the sensor in the middle; > 0. There is no bottom.
  double sensor_x_m = 0.1;           ///< from the tank's centre along its walls; inside
  double sensor_y_m = -0.45;         ///< the same to the left
  double sensor_yaw_rad = 0.05;      ///< of the sensor in the tank, counter-clockwise
  double floater_bearing_rad = 1.6;  ///< of its axis
  double floater_range_m = 1.8;      ///< of its axis; the sensor is outside of it
  double floater_radius_m = 0.15;    ///< >= 0; 0: no floater

  OptionErrors errors() const;    ///< what is wrong with each field
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

}  // namespace pingvox
