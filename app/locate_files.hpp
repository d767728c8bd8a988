#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/locate_recording.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/sonar/sound_speed.hpp"

namespace pingvox::app {

/// Motion of the vehicle, as far as the files of `locate` tell it.
struct LocateMotion {
  RecordedMotion recorded;
  std::string text = "none: the vehicle is assumed to move little";
  MotionNoise noise;  ///< of the odometry
  std::optional<NavOffset> clock;
  std::optional<Water> water;  ///< by the navigation log, where it was asked
  NavOthers others;            ///< sources of velocity and heading that were not used
  std::size_t skipped = 0;
  Eigen::Vector3d sonar_moved_m = Eigen::Vector3d::Zero();  ///< added to the place of the sonar: by a calibration
  std::vector<std::string> warnings = {};                   ///< each begins with the name of a file
};

Result<LocateMotion> read_motion(const LocateCommand& command);
/// The beams of all logs, at least one.
/// @param skipped  damaged records are added
Result<std::vector<Beam>> read_beams(const LocateCommand& command, std::size_t& skipped);
Result<OccupancyMap> read_map_file(const std::string& name);

}  // namespace pingvox::app
