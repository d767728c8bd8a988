#pragma once

#include <string>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox {

/// A number that was estimated.
struct Estimate {
  double value = 0.0;
  double deviation = 0.0;  ///< its standard deviation
};

/// Deviation of a heading source from the body's yaw: constant + sin1 sin(yaw) + cos1 cos(yaw) + the same of 2 yaw
/// [rad].
struct HeadingCalibration {
  std::string source;
  Estimate constant_rad, sin1_rad, cos1_rad, sin2_rad, cos2_rad;
};

/// What SlamSmoother estimates besides the trajectory: errors of the sensors and of their mounts.
struct SlamCalibration {
  std::string velocity;           ///< name of the velocity's source
  Estimate velocity_yaw_rad;      ///< by which the velocity's source is turned against its mount, counter-clockwise
  Estimate velocity_scale;        ///< true over measured velocity, less 1
  Estimate wall_in_echo;          ///< where the wall is in a run of bins: -1 its first bin, 0 its middle, 1 its last
  Estimate sonar_x_m, sonar_y_m;  ///< added to the place of the sonar
  std::vector<HeadingCalibration> headings;

  /// @return kBadOption: a number is not finite, a standard deviation is not above 0, the scale is not above -1, a
  ///         heading is repeated, or its deviation turns faster than the vehicle and so has no inverse
  Result<void> validate() const;
  /// nullptr: there is none of this name.
  const HeadingCalibration* heading(const std::string& source) const;
};

}  // namespace pingvox
