#pragma once

#include <cmath>

#include "pingvox/geometry/pose.hpp"

/// How a head is mounted whose beams are taken as those of a plane.
namespace pingvox {

/// Whether its beams are near the plane of the vehicle: within 45 degrees.
inline bool is_level(const Pose& body_from_sonar) {
  constexpr double kCos45 = 0.7;
  return std::abs(body_from_sonar.rotation()(2, 2)) > kCos45;
}

/// Whether its bearings run clockwise, seen from above the vehicle.
inline bool is_upside_down(const Pose& body_from_sonar) {
  return body_from_sonar.rotation()(2, 2) < 0.0;
}

}  // namespace pingvox
