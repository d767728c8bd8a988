#pragma once

#include <cstddef>
#include <string>

#include "commands.hpp"
#include "pingvox/recording/recording.hpp"

namespace pingvox::app {

/// Of wall time.
struct LocateSeconds {
  double read = 0.0, total = 0.0;
};

/// Poses that may be wrong.
std::size_t unsure_poses(const LocatedRecording& found);

/// Result of `locate` as JSON and as text.
/// @param written  poses
std::string locate_json(const Recording& recording, const RecordingLocation& location, std::size_t written,
                        const LocateSeconds& seconds);
std::string locate_text(const Recording& recording, const RecordingLocation& location, const LocateCommand& command,
                        std::size_t written, const LocateSeconds& seconds);

}  // namespace pingvox::app
