#pragma once

#include <cstdint>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

class OptionErrors;

/// Navigation sensors of a simulated vehicle, all at the origin of its body frame: a DVL, an attitude sensor with
/// compass and gyros, and a depth sensor. Errors that are constant over a run are drawn with the standard deviations
/// given here. Defaults: about those of the marina's recording (docs/slam-figures.md).
struct NavSensorOptions {
  std::uint64_t seed = 1;

  // The DVL.
  double dvl_per_s = 3.0;      ///< measurements; > 0, at most 100
  double dvl_noise_m_s = 0.1;  ///< standard deviation on each axis; 0..10
  double dvl_outliers = 0.02;  ///< fraction of measurements that are wrong by some 1 m/s on each axis; 0..1
  double dvl_lost = 0.02;      ///< fraction of time without bottom lock, for some 5 s each; 0 or more, less than 1
  double dvl_yaw_rad = 3.0 * kDegree_rad;  ///< deviation of the angle it is turned by; 0..1
  double dvl_scale = 0.005;                ///< deviation of true over measured velocity; 0..0.1

  // The attitude sensor.
  double attitude_per_s = 10.0;                      ///< measurements; > 0, at most 100
  double attitude_noise_rad = 0.3 * kDegree_rad;     ///< standard deviation of each angle; 0..1
  double compass_deviation_rad = 3.0 * kDegree_rad;  ///< of the coefficients of the sine and the cosine of
                                                     ///< yaw; a third of it for its double and the
                                                     ///< constant; 0..0.3
  double gyro_noise_rad_s = 0.1 * kDegree_rad;       ///< standard deviation on each axis; 0..1
  double gyro_drift_rad_s = 0.02 * kDegree_rad;      ///< deviation of the bias of the turn rate at the
                                                     ///< start, and of its change in ten minutes; 0..1

  // The depth sensor.
  double depth_per_s = 5.0;     ///< measurements; > 0, at most 100
  double depth_noise_m = 0.02;  ///< standard deviation; 0..10

  double delay_s =
      0.1;  ///< by which the clock of all three is ahead of the sonar's: times are too late by it; -3600..3600

  OptionErrors errors() const;    ///< what is wrong with each field
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The errors that were drawn, which a calibration should find. Signs as in SlamCalibration.
struct NavSensorErrors {
  double dvl_yaw_rad = 0.0;  ///< by which the DVL is turned on the vehicle, counter-clockwise
  double dvl_scale = 0.0;    ///< true over measured velocity, less 1
  /// The compass measures yaw + constant + sin1 sin(yaw) + cos1 cos(yaw) + sin2 sin(2 yaw) + cos2 cos(2 yaw).
  double constant_rad = 0.0, sin1_rad = 0.0, cos1_rad = 0.0, sin2_rad = 0.0, cos2_rad = 0.0;
  double gyro_bias_start_rad_s = 0.0, gyro_bias_end_rad_s = 0.0;  ///< about the vertical axis
};

struct SimulatedNav {
  /// Sources "DVL" (velocity), "IMU" (attitude and turn rate) and "depth", which counts from z = 0. The map frame's x
  /// is east.
  NavLog log;
  NavSensorErrors errors;
};

/// Measurements of the sensors along a true trajectory. The same options give the same numbers. REQUIRES valid options,
/// from_s <= to_s and at most 100,000 s.
SimulatedNav simulate_nav(const Trajectory& map_from_body, double from_s, double to_s, const NavSensorOptions& options);

}  // namespace pingvox
