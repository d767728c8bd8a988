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

/// What tells SLAM how the vehicle moves.
enum class LiveMotion {
  kUndecided,        ///< some seconds of beams and navigation are waited for
  kVelocity,         ///< a velocity over ground and a heading
  kSonarAndHeading,  ///< how sweeps match each other, and a heading or turn rates
  kSonar,            ///< how sweeps match each other alone
};

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
/// No pose has come for five seconds: beams are not mapped.
struct PosesEnded {};
/// Poses come again.
struct PosesResumed {};
/// Poses come, and yet no beam got one for five seconds, or most did not for ten: they are not mapped. Told once, until
/// BeamsWithPose.
struct BeamsWithoutPose {
  std::size_t beams = 0, without_pose = 0;  ///< of these seconds
  double within_s = 0.0;                    ///< how many seconds
  // Why; neither: not known.
  std::optional<double> behind_s;  ///< how far poses are behind the beams when they come; negative: ahead
  std::optional<double> apart_s;   ///< longest time from one pose that came to the next: longer than a beam waits
};
/// Nearly all beams get poses again.
struct BeamsWithPose {};
/// Judged by their arrival, the stamps of a navigation device are steadily apart from those of the sonar: beams are
/// mapped where the vehicle was at another time, unless messages of one of them come that late. Told once, until they
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
/// A message of ROS 2 was not published; later ones are tried.
struct NotPublished {
  std::string reason;
};
/// What SLAM tells the motion of the vehicle by, from now on.
struct MotionChosen {
  LiveMotion motion = LiveMotion::kUndecided;
  std::string velocity, heading;  ///< sources; empty: none
  /// Standard deviation of the way after one second [m / sqrt(s)]; nullopt: the sonar will tell it (LiveSlamStatus).
  std::optional<double> deviation_m_sqrt_s;
};
/// The vehicle is located in the known map: poses are in its frame from now on, and beams before are mapped, too.
struct Located {
  std::string map;
  PoseHypothesis where;
};
/// The vehicle is not located in the known map yet: beams are not mapped, and it is tried on. Told once.
struct NotLocated {
  std::string map;
  std::size_t sweeps = 0;                  ///< so far
  std::vector<PoseHypothesis> hypotheses;  ///< the most likely first; empty: echoes fit nowhere
};
/// A velocity that tells the motion was not measured for a second. Poses go on by the last one and the heading, for
/// some ten seconds, then by how sweeps match, where they do.
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
/// SLAM has seen places again: the path is corrected, and then the map.
struct LoopClosed {
  std::size_t loops = 0;  ///< kept since the last time
  double moved_m = 0.0;   ///< how far a beam moved that was mapped already, at most
};
/// The poses cannot be told (any more): later beams are recorded, and mapped if a later solution tells where they are.
/// Told once.
struct SlamFailed {
  Error error;
};
/// Messages arrive, and cannot be used: all of them, or the attitudes that they tell.
struct MessagesRefused {
  std::string device, reason;
};
/// Several nodes publish one topic at the same time, and the messages of all are taken. Told once for each device.
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

/// The error of an event that is one (RecordingFailed, MappingFailed, NavFailed); nullptr for others.
const Error* error_of(const LiveEvent& event);

}  // namespace pingvox
