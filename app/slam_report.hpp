#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/slam/scan_slam.hpp"

namespace pingvox::app {

/// Beams of all logs, on the map and left out of it.
struct MappedBeams {
  std::size_t beams = 0, skipped = 0;
  double resolution_m = 0.0;
  std::string resolution = {};  ///< as text, with its reason
};

/// What else there is to report.
struct SlamInputs {
  std::vector<OtherSource> others;                   ///< sources of velocity and heading that were not used
  std::optional<MappedBeams> mapped = std::nullopt;  ///< nullopt: there is no map
};

/// Of wall time.
struct SlamSeconds {
  double read = 0.0, solve = 0.0, map = 0.0, write = 0.0, total = 0.0;
};

/// Result of `slam` on beams, as JSON and as text.
std::string slam_json(const Recording& recording, const RecordingSlam& slam, const SlamCommand& command,
                      const SlamInputs& inputs, const SlamSeconds& seconds);
std::string slam_text(const Recording& recording, const RecordingSlam& slam, const SlamCommand& command,
                      const SlamInputs& inputs, const SlamSeconds& seconds);

/// Result of `slam` on scans of points.
std::string scan_slam_json(const ScanSlamReport& report, std::size_t skipped, const SlamSeconds& seconds);
std::string scan_slam_text(const ScanSlamReport& report, const SlamCommand& command, const SlamSeconds& seconds);

}  // namespace pingvox::app
