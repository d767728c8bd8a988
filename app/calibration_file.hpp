#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/odometry.hpp"
#include "pingvox/slam/slam_calibration.hpp"

namespace pingvox::app {

/// What 'slam --calibration' and 'simulate --truth' write and --use-calibration reads, as TOML.
struct CalibrationFile {
  SlamCalibration calibration;
  /// How the sources of navigation were said to be mounted (--nav-mount): what the calibration is relative to.
  std::map<std::string, Pose> body_from_source;
};

std::string calibration_toml(const CalibrationFile& file);

/// @return kIo when it cannot be read; kCorrupt naming the line of what is unknown, missing, there twice or no number;
///         a calibration that cannot be used is named without a line
Result<CalibrationFile> read_calibration(const std::string& path);

/// Corrects dead reckoning by a file; mounts that `options` has already win.
/// @return what is added to the place of the sonar on the vehicle [m]; errors as above
Result<Eigen::Vector3d> use_calibration(const std::string& path, OdometryOptions& options);

}  // namespace pingvox::app
