#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pingvox/sim/tank.hpp"

namespace pingvox::bench {

/// A ray in the tank's frame: origin at the centre of the square, axes along its walls.
struct PlaneRay {
  double x, y;
  double dx, dy;
};

inline PlaneRay ray_at(const TankOptions& o, double bearing_rad) {
  const double angle = o.sensor_yaw_rad + bearing_rad;
  return {o.sensor_x_m, o.sensor_y_m, std::cos(angle), std::sin(angle)};
}

/// Distance along one axis to the wall at +half or -half.
inline double wall_distance(double from, double direction, double half) {
  if (direction == 0.0) return std::numeric_limits<double>::infinity();
  return ((direction > 0.0 ? half : -half) - from) / direction;
}

inline std::optional<double> floater_distance(const TankOptions& o, const PlaneRay& ray) {
  if (o.floater_radius_m == 0.0) return std::nullopt;
  const PlaneRay axis = ray_at(o, o.floater_bearing_rad);
  const double to_x = axis.x + o.floater_range_m * axis.dx - ray.x;
  const double to_y = axis.y + o.floater_range_m * axis.dy - ray.y;
  const double along = to_x * ray.dx + to_y * ray.dy;
  const double across = to_x * ray.dy - to_y * ray.dx;
  const double chord_squared = o.floater_radius_m * o.floater_radius_m - across * across;
  if (along <= 0.0 || chord_squared < 0.0) return std::nullopt;
  return along - std::sqrt(chord_squared);
}

/// Range [m] along the axis of a beam to the first wall or the floater, in closed form: independent of `World`, so that
/// tests can compare the two.
/// REQUIRES valid options.
inline double true_range_m(const TankOptions& options, double bearing_rad) {
  const PlaneRay ray = ray_at(options, bearing_rad);
  const double half = 0.5 * options.side_m;
  const double wall = std::min(wall_distance(ray.x, ray.dx, half), wall_distance(ray.y, ray.dy, half));
  return std::min(wall, floater_distance(options, ray).value_or(wall));
}

}  // namespace pingvox::bench
