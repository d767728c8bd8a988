#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "device/internal/live_source.hpp"
#include "live/recordings.hpp"
#include "pingvox/live/live_options.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The file to record the sonar to; nullopt: none. Makes the folder, when there is neither a file nor a folder of that
/// name and it has no suffix. kIo when it cannot.
/// @param since_1970_ms  the start, by which a file in a folder is named
Result<std::optional<std::filesystem::path>> record_path(const LiveOptions& options, std::uint64_t since_1970_ms);

/// The recorder of a head, whose file must not exist; nullopt: nothing is recorded.
/// @param since_1970_ms  the date of time 0
Result<std::optional<HeadRecorder>> head_recorder(const LiveHead& head, Recordings& recordings,
                                                  std::uint64_t since_1970_ms);

/// @param since_1970_ms  the date of time 0
/// @param node           for topics of ROS 2
Result<std::unique_ptr<LiveSource>> open_head(const LiveHead& head, Recordings& recordings, std::uint64_t since_1970_ms,
                                              const std::optional<Ros2Node>& node);

}  // namespace pingvox
