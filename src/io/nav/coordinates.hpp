#pragma once

#include <fmt/core.h>

#include <Eigen/Core>
#include <string>

#include "io/bytes/byte_writer.hpp"

/// Coordinates of points in files of clouds.
namespace pingvox {

/// Float where that moves no point by more than a quarter of a millimetre.
enum class Coordinates { kFloat, kDouble };

/// @param farthest_m  the largest absolute coordinate
inline Coordinates coordinates_up_to(double farthest_m) {
  constexpr double kFloat_m = 4096.0;
  return farthest_m <= kFloat_m ? Coordinates::kFloat : Coordinates::kDouble;
}

inline void put_point(const Eigen::Vector3d& point_m, Coordinates coordinates, ByteWriter& writer) {
  for (const double value : point_m) {
    coordinates == Coordinates::kFloat ? writer.put(static_cast<float>(value)) : writer.put(value);
  }
}

/// "1.025 2.5 -0.275"
inline std::string text_of(const Eigen::Vector3d& point_m, Coordinates coordinates) {
  if (coordinates == Coordinates::kDouble) {
    return fmt::format("{:.10g} {:.10g} {:.10g}", point_m.x(), point_m.y(), point_m.z());
  }
  const Eigen::Vector3f rounded_m = point_m.cast<float>();
  return fmt::format("{} {} {}", rounded_m.x(), rounded_m.y(), rounded_m.z());
}

}  // namespace pingvox
