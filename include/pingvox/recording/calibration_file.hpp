#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_calibration.hpp"

namespace pingvox {

/// The calibration of a vehicle's sensors as found by SLAM, for its other recordings.
struct CalibrationFile {
  SlamCalibration calibration;
  /// The given mounts of the navigation sources, to which the calibration is relative.
  std::map<std::string, Pose> body_from_source;
};

/// As TOML: each number and its standard deviation.
std::string calibration_toml(const CalibrationFile& file);
/// @return kCorrupt with the line of an unknown, missing, repeated or invalid value; an invalid calibration without one
Result<CalibrationFile> read_calibration(const FileBytes& file);

/// What is added to the place of the sonar on the vehicle [m].
inline Eigen::Vector3d sonar_moved_by(const SlamCalibration& calibration) {
  return {calibration.sonar_x_m.value, calibration.sonar_y_m.value, 0.0};
}

}  // namespace pingvox
