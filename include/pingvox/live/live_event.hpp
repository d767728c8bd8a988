#pragma once

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// What happens while LiveMapping runs, beside beams. Devices are named as in LiveStatus.
namespace live_event {

/// A device answers.
struct Connected {
  std::string device;
};
/// A device does not answer, or not any more; it is tried again.
struct NotConnected {
  std::string device, reason;
};
/// A recording has failed; mapping goes on. Told once for each recording.
struct RecordingFailed {
  Error error;
};
/// The map cannot grow any more (kLimit, kNoMemory): the recording goes on, and beams are counted as not mapped.
struct MappingFailed {
  Error error;
};
/// A navigation device can no longer be read; the recording of the sonar goes on. Told once.
struct NavFailed {
  Error error;
};
/// A beam that does not fit its request: such beams are recorded and not mapped. Told once.
struct UnexpectedBeam {
  std::string device, reason;
};
/// The sources of the poses are known, and kept from now on.
struct SourcesChosen {
  std::string attitude, position;
};
/// Five seconds have passed, and no source of poses is known: beams are not mapped. Told once.
struct NoSourceYet {
  bool has_attitude = false, has_position = false;  ///< whether any came
  std::size_t messages = 0;
};
/// No pose is known of the last five seconds: beams are not mapped.
struct PosesEnded {};
/// Poses are known again.
struct PosesResumed {};
/// The vehicle that was followed fell silent, and another sender is followed in its place.
struct VehicleChanged {
  std::string device, vehicle;
};
/// A sender is ignored, because another one is followed.
struct SenderIgnored {
  std::string device, sender, vehicle;
};
/// The sender of the positions has restarted: they are relative to another origin since then, and the map does not fit.
/// Told once for each device.
struct SenderRestarted {
  std::string device, position;
};
/// A source is in another frame since a step that no vehicle makes: the map does not fit any more.
struct NewFrame {
  std::string source;
  NavQuantity quantity = NavQuantity::kPosition;
  SourceStep step;
};
/// Obstacles cannot be sent; it is tried again.
struct ObstaclesNotSent {
  std::string reason;
};
/// Obstacles are sent again.
struct ObstaclesSent {};

}  // namespace live_event

using LiveEvent =
    std::variant<live_event::Connected, live_event::NotConnected, live_event::RecordingFailed,
                 live_event::MappingFailed, live_event::NavFailed, live_event::UnexpectedBeam,
                 live_event::SourcesChosen, live_event::NoSourceYet, live_event::PosesEnded, live_event::PosesResumed,
                 live_event::VehicleChanged, live_event::SenderIgnored, live_event::SenderRestarted,
                 live_event::NewFrame, live_event::ObstaclesNotSent, live_event::ObstaclesSent>;

/// The error of an event that is one (RecordingFailed, MappingFailed, NavFailed); nullptr for others.
const Error* error_of(const LiveEvent& event);

}  // namespace pingvox
