#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/random.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

class OptionErrors;

struct NavEmulatorOptions {
  double reports_per_s = 10.0;  ///< 0.1..1000
  // Faults of the line, as fractions of the messages.
  double lost = 0.0, doubled = 0.0, damaged = 0.0;  ///< 0..0.5 each
  std::uint64_t seed = 1;                           ///< of the faults

  OptionErrors errors() const;    ///< what is wrong with each field
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// A device that periodically reports the pose of a vehicle. It has no line and no clock of its own: the caller carries
/// the messages.
class NavEmulator {
 public:
  using Message = std::vector<std::uint8_t>;
  /// map_from_body at a time [s].
  using PoseAt = std::function<Pose(double)>;
  /// The reports at a time [s].
  using Say = std::function<std::vector<Message>(double)>;

  /// An autopilot (system 1, component 1) that sends MAVLink 2: HEARTBEAT, ATTITUDE, LOCAL_POSITION_NED and, of the
  /// depth below z = 0, SCALED_PRESSURE2. It was started at time 0.
  static Say mavlink(PoseAt pose_at);
  /// Whether a DVL measures its velocity over ground at a time [s].
  using HasBottom = std::function<bool(double)>;
  /// A Water Linked A50 that sends lines of JSON: `velocity` and `position_local`, whose axes are north, east and down.
  /// Where it has no bottom it says that its velocity is not valid, and its position stays.
  static Say a50(PoseAt pose_at, HasBottom has_bottom = nullptr);

  /// REQUIRES valid options.
  NavEmulator(const NavEmulatorOptions& options, Say say);

  /// When the next messages are to be sent.
  double due_s() const { return due_s_; }
  /// The messages to send now, with the faults of the line.
  std::vector<Message> send(double now_s);

 private:
  NavEmulatorOptions options_;
  Say say_;
  double due_s_ = 0.0;
  Random random_;
};

}  // namespace pingvox
