#pragma once

#include <optional>
#include <string_view>

#include "io/internal/mavlink.hpp"

namespace pingvox {

/// A message of MAVLink in the JSON of Blue Robotics' software (docs/formats.md) as the frame that it was sent as.
/// Numbers of single precision are rounded once, so they are those of the frame to the bit. Of messages that MavlinkNav
/// does not convert only the sender is known.
/// @return nullopt when it is none, or lacks a number that MavlinkNav needs
std::optional<MavlinkFrame> mavlink_frame_of_json(std::string_view text);

/// Whether MavlinkNav converts messages of a name, as in "ATTITUDE".
bool is_converted_mavlink(std::string_view name);

}  // namespace pingvox
