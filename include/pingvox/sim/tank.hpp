#pragma once

#include "pingvox/result.hpp"

namespace pingvox {

/// A square tank with vertical walls, and a floater (a vertical cylinder) in it. Lengths and angles are those of a
/// sensor that stands still in it, which is the origin of the map frame. Defaults: about the tank of the paper's
/// recording.
struct TankOptions {
  double side_m = 4.5;               ///< of the square, > 0
  double depth_m = 4.0;              ///< of the walls, the sensor in the middle; > 0. There is no bottom.
  double sensor_x_m = 0.1;           ///< from the tank's centre along its walls; inside
  double sensor_y_m = -0.45;         ///< the same to the left
  double sensor_yaw_rad = 0.05;      ///< of the sensor in the tank, counter-clockwise
  double floater_bearing_rad = 1.6;  ///< of its axis
  double floater_range_m = 1.8;      ///< of its axis; the sensor is outside of it
  double floater_radius_m = 0.15;    ///< >= 0; 0: no floater

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// How far the middle of a beam goes in the plane of the sensor until it meets a wall or the floater, in closed form:
/// it knows nothing of `World`, so that one can be held against the other.
/// REQUIRES valid options.
double true_range_m(const TankOptions& options, double bearing_rad);

}  // namespace pingvox
