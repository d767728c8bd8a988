#pragma once

#include <map>
#include <optional>
#include <string>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_calibration.hpp"

namespace pingvox {

/// The source of a vehicle's yaw.
enum class TurnsBy {
  kHeading,   ///< a compass, whose errors do not grow, but change as the vehicle turns
  kTurnRate,  ///< a gyro where there is one all the time, else the heading: exact for minutes, but north is lost
};

struct OdometryOptions {
  /// How a source is mounted: body_from_source by its name; the identity for others.
  std::map<std::string, Pose> body_from_source;
  double offset_s = 0.0;  ///< added to the times of the navigation
  TurnsBy turns = TurnsBy::kHeading;
  /// Corrects velocity and heading; must be valid. nullopt: they are used as they are.
  std::optional<SlamCalibration> calibration = std::nullopt;
};

/// Dead reckoning of a vehicle from its navigation; errors accumulate.
struct Odometry {
  Trajectory odometry_from_body;  ///< begins at x, y = 0; z is less the depth, 0 where there is none
  std::string heading;            ///< name of the source of heading or attitude
  std::string velocity;           ///< empty: there is none, and x and y stay 0
};

/// Integrates the velocity with most samples along the heading with most samples.
/// @return kUnsupported without a valid heading or attitude, or when velocity and heading do not overlap in time;
///         kBadOption when a mount is of none of the sources, or the calibration is of another velocity or lacks the
///         heading; kCorrupt when the clock of a velocity, a heading, an attitude, a turn rate or the depth was set
///         back
Result<Odometry> odometry_of(const NavLog& log, const OdometryOptions& options);

}  // namespace pingvox
