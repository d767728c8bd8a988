#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "pingvox/device/live_source.hpp"
#include "pingvox/result.hpp"
#include "recordings.hpp"

namespace pingvox::app {

/// When the beams' clock was 0.
struct LiveStart {
  double s = 0.0;                   ///< of the stopwatch
  std::uint64_t since_1970_ms = 0;  ///< the same as a date
};

/// The file to record the sonar to; nullopt: none. Makes the folder, when there is neither a file nor a folder of that
/// name and it has no suffix. kIo when it cannot.
Result<std::optional<std::filesystem::path>> record_path(const LiveCommand& command, const LiveStart& start);

Result<std::unique_ptr<LiveSource>> open_live_sonar(const LiveCommand& command, Recordings& recordings,
                                                    const LiveStart& start);

}  // namespace pingvox::app
