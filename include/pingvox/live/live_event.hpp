#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/localizer.hpp"

namespace pingvox {

/// What SLAM estimates the motion of the vehicle from.
enum class LiveMotion {
  kUndecided,        ///< waits for some seconds of beams and navigation
  kVelocity,         ///< a velocity over ground and a heading
  kSonarAndHeading,  ///< matches of sweeps, and a heading or turn rates
  kSonar,            ///< matches of sweeps alone
};

/// What happens while LiveMapping runs, beside beams. Devices are named as in LiveStatus.
namespace live_event {

/// A device answers.
struct Connected {
  std::string device;
};
/// A device does not answer, or not any more; retried.
struct NotConnected {
  std::string device, reason;
};
/// A recording has failed; mapping goes on. Reported once for each recording.
struct RecordingFailed {
  Error error;
};
/// The map cannot grow any more (kLimit, kNoMemory): the recording goes on, and beams are counted as not mapped.
struct MappingFailed {
  Error error;
};
/// A navigation device can no longer be read; the recording of the sonar goes on. Reported once.
struct NavFailed {
  Error error;
};
/// A beam that does not fit its request: such beams are recorded and not mapped. Reported once.
struct UnexpectedBeam {
  std::string device, reason;
};
/// The sources of the poses are known, and kept from now on.
struct SourcesChosen {
  std::string attitude, position;
};
/// Five seconds have passed, and no source of poses is known: beams are not mapped. Reported once.
struct NoSourceYet {
  bool has_attitude = false, has_position = false;  ///< whether any came
  std::size_t messages = 0;
};
/// No pose has come for five seconds: beams are not mapped.
struct PosesEnded {};
/// Poses come again.
struct PosesResumed {};
/// Poses arrive, but no beam got one for five seconds, or most did not for ten: they are not mapped. Reported once,
/// until BeamsWithPose.
struct BeamsWithoutPose {
  std::size_t beams = 0, without_pose = 0;  ///< of these seconds
  double within_s = 0.0;                    ///< how many seconds
  // Why; neither: unknown.
  std::optional<double> behind_s;  ///< how far poses are behind the beams when they come; negative: ahead
  std::optional<double> apart_s;   ///< longest time from one pose that came to the next: longer than a beam waits
};
/// Nearly all beams get poses again.
struct BeamsWithPose {};
/// By their arrival, the stamps of a navigation device differ steadily from those of the sonar: beams are mapped where
/// the vehicle was at another time, unless messages of one of them are that late. Reported once, until they
/// agree.
struct ClocksDiffer {
  std::string device, head;
  double ahead_s = 0.0;  ///< the stamps of the device; negative: behind
};
/// The vehicle that was followed fell silent, and another sender is followed in its place.
struct VehicleChanged {
  std::string device, vehicle;
};
/// A sender is ignored, because another one is followed.
struct SenderIgnored {
  std::string device, sender, vehicle;
};
/// The sender of the positions has restarted: they are relative to another origin since then, and the map does not fit.
/// Reported once for each device.
struct SenderRestarted {
  std::string device, position;
};
/// A source is in another frame since a step that no vehicle makes: the map does not fit any more.
struct NewFrame {
  std::string source;
  NavQuantity quantity = NavQuantity::kPosition;
  SourceStep step;
};
/// Obstacles cannot be sent; retried.
struct ObstaclesNotSent {
  std::string reason;
};
/// Obstacles are sent again.
struct ObstaclesSent {};
/// A message of ROS 2 was not published; later ones are tried.
struct NotPublished {
  std::string reason;
};
/// What SLAM estimates the motion of the vehicle from, from now on.
struct MotionChosen {
  LiveMotion motion = LiveMotion::kUndecided;
  std::string velocity, heading;  ///< sources; empty: none
  /// Standard deviation of the displacement after one second [m / sqrt(s)]; nullopt: estimated later from the sonar
  /// (LiveSlamStatus).
  std::optional<double> deviation_m_sqrt_s;
};
/// The vehicle is located in the known map: poses are in its frame from now on, and earlier beams are mapped as well.
struct Located {
  std::string map;
  PoseHypothesis where;
};
/// The vehicle is not located in the known map yet: beams are not mapped, and the search goes on. Reported once.
struct NotLocated {
  std::string map;
  std::size_t sweeps = 0;                  ///< so far
  std::vector<PoseHypothesis> hypotheses;  ///< the most likely first; empty: echoes match nowhere
};
/// The velocity in use was not measured for a second. Poses are predicted from the last one and the heading for some
/// ten seconds, then from matches of sweeps, where there are any.
struct VelocityEnded {
  std::string velocity;
};
/// It is measured again.
struct VelocityResumed {
  std::string velocity;
  double missing_s = 0.0;  ///< how long it was not, at least
};
/// The position may be some metres off: beams wait for a solution, and no obstacles are sent until then.
struct PositionUncertain {
  double deviation_m = 0.0;  ///< standard deviation since the last solution
};
/// SLAM has closed loops: the path is corrected, and then the map.
struct LoopClosed {
  std::size_t loops = 0;  ///< kept since the last time
  double moved_m = 0.0;   ///< largest correction of a beam that was mapped already
};
/// Poses cannot be estimated (any more): later beams are recorded, and mapped if a later solution has their poses.
/// Reported once.
struct SlamFailed {
  Error error;
};
/// Messages arrive, and cannot be used: all of them, or their attitudes.
struct MessagesRefused {
  std::string device, reason;
};
/// Several nodes publish one topic at the same time, and all their messages are used. Reported once for each device.
struct SeveralPublishers {
  std::string device;
  std::size_t publishers = 0;  ///< at least
};

}  // namespace live_event

using LiveEvent = std::variant<
    live_event::Connected, live_event::NotConnected, live_event::RecordingFailed, live_event::MappingFailed,
    live_event::NavFailed, live_event::UnexpectedBeam, live_event::SourcesChosen, live_event::NoSourceYet,
    live_event::PosesEnded, live_event::PosesResumed, live_event::BeamsWithoutPose, live_event::BeamsWithPose,
    live_event::ClocksDiffer, live_event::VehicleChanged, live_event::SenderIgnored, live_event::SenderRestarted,
    live_event::NewFrame, live_event::ObstaclesNotSent, live_event::ObstaclesSent, live_event::NotPublished,
    live_event::MotionChosen, live_event::Located, live_event::NotLocated, live_event::VelocityEnded,
    live_event::VelocityResumed, live_event::PositionUncertain, live_event::LoopClosed, live_event::SlamFailed,
    live_event::MessagesRefused, live_event::SeveralPublishers>;

/// The error of RecordingFailed, MappingFailed and NavFailed; nullptr for others.
const Error* error_of(const LiveEvent& event);

}  // namespace pingvox
