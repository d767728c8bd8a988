#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_calibration.hpp"

namespace pingvox {

/// What SLAM found of the sensors of a vehicle, for other recordings of it.
struct CalibrationFile {
  SlamCalibration calibration;
  /// How the sources of navigation were said to be mounted: what the calibration is relative to.
  std::map<std::string, Pose> body_from_source;
};

/// As TOML: each number and its standard deviation.
std::string calibration_toml(const CalibrationFile& file);
/// @return kCorrupt naming the line of what is unknown, missing, there twice or no number; a calibration that cannot be
///         used is named without a line
Result<CalibrationFile> read_calibration(const FileBytes& file);

/// What is added to the place of the sonar on the vehicle [m].
inline Eigen::Vector3d sonar_moved_by(const SlamCalibration& calibration) {
  return {calibration.sonar_x_m.value, calibration.sonar_y_m.value, 0.0};
}

}  // namespace pingvox
