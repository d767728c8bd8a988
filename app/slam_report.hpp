#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "commands.hpp"
#include "nav_clock.hpp"
#include "nav_report.hpp"
#include "pingvox/slam/scan_slam.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/sound_speed.hpp"

namespace pingvox::app {

/// Beams of all logs, on the map and left out of it.
struct MappedBeams {
  std::size_t beams = 0, skipped = 0;
};

/// What was read besides beams, velocity and headings.
struct SlamInputs {
  NavOffset nav_offset;
  std::optional<Water> nav_water;     ///< by the navigation log, where it was asked
  NavOthers nav_others;               ///< sources of velocity and heading that were not used
  std::size_t skipped = 0;            ///< records
  std::optional<MappedBeams> mapped;  ///< nullopt: there is no map
};

/// Of wall time.
struct SlamSeconds {
  double read = 0.0, solve = 0.0, map = 0.0, write = 0.0, total = 0.0;
};

/// Result of `slam` on beams, as JSON and as text.
std::string slam_json(const SlamSolution& solution, const SlamCommand& command, const SlamInputs& inputs,
                      const SlamOptions& slam, const SlamSeconds& seconds);
std::string slam_text(const SlamSolution& solution, const SlamCommand& command, const SlamInputs& inputs,
                      const SlamSeconds& seconds);

/// Result of `slam` on scans of points.
std::string scan_slam_json(const ScanSlamReport& report, std::size_t skipped, const SlamSeconds& seconds);
std::string scan_slam_text(const ScanSlamReport& report, const SlamCommand& command, const SlamSeconds& seconds);

}  // namespace pingvox::app
