#pragma once

#include <cstddef>
#include <string>

#include "commands.hpp"
#include "locate_files.hpp"
#include "pingvox/slam/locate_recording.hpp"

namespace pingvox::app {

/// What `locate` worked on, and how much it wrote.
struct LocateInputs {
  LocateMotion motion;
  std::size_t beams = 0, skipped = 0;  ///< skipped: records of logs and navigation
  double recorded_s = 0.0, sound_speed_m_s = 0.0;
  std::size_t field_bytes = 0;  ///< of the distance field
  std::size_t written = 0;      ///< poses
};

/// Of wall time.
struct LocateSeconds {
  double read = 0.0, field = 0.0, locate = 0.0, total = 0.0;
};

/// Poses that may be wrong.
std::size_t unsure_poses(const LocatedRecording& found);

/// Result of `locate` as JSON and as text.
std::string locate_json(const LocatedRecording& found, const LocateInputs& inputs, const LocateSeconds& seconds);
std::string locate_text(const LocatedRecording& found, const LocateCommand& command, const LocateInputs& inputs,
                        const LocateSeconds& seconds);

}  // namespace pingvox::app
