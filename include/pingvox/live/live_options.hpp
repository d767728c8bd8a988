#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pingvox/device/head_settings.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/mapping/head_options.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_smoother.hpp"

namespace pingvox {

/// A sonar head, or a log that is replayed in its place.
struct LiveHead {
  enum class Kind {
    kPing360,
    kMicron,  ///< a SeaNet head: Micron or MiniKing
    kReplay,  ///< a log of beams, at the pace of its times
  };
  Kind kind = Kind::kPing360;
  /// Of a head "udp://192.168.2.2:9092", or a serial port as "/dev/ttyUSB0" or "/dev/ttyUSB0@57600"; of a Micron also
  /// "tcp://HOST:PORT". Of a replay the file.
  std::string address = {};
  double speed = 1.0;            ///< of a replay, > 0; infinity: as fast as it can be mapped
  Ping360Settings ping360 = {};  ///< how a Ping360 is driven
  MicronSettings micron = {};    ///< how a Micron is driven

  /// "ping360:udp://192.168.2.2:9092"
  std::string name() const;
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// A device that reports where the vehicle is.
struct LiveNav {
  enum class Kind {
    kMavlink,  ///< an autopilot that sends MAVLink to "udp://:14550" of this host, or "udp://ADDRESS:14550"
    kA50,      ///< a Water Linked DVL, whose server is "tcp://HOST:16171"
  };
  Kind kind = Kind::kMavlink;
  std::string address = {};

  Result<void> validate() const;  ///< kBadOption for an address that can never be opened
};

struct LiveOptions {
  LiveHead head = {};
  /// All are recorded; the poses are of one position and one attitude. Empty: the vehicle stands still.
  std::vector<LiveNav> nav = {};
  /// The sonar's log, a file that does not exist yet, or a folder, in which it is named by the time. A name without a
  /// suffix is a folder, which is made. The records of `nav` are beside it, with other suffixes. nullopt: no recording.
  std::optional<std::string> record = std::nullopt;
  /// "udp://HOST:PORT" of an autopilot, which is sent the nearest obstacles (MAVLink's OBSTACLE_DISTANCE).
  std::optional<std::string> obstacles = std::nullopt;
  /// Poses by CausalSlam, from the sonar and what `nav` tells of velocity, heading and depth. What of it tells the
  /// motion is found; mount, filter, echoes and speed of sound are those of `build`. nullopt: no SLAM.
  std::optional<SlamOptions> slam = std::nullopt;
  MapOptions map = {};
  BuildOptions build = {};  ///< but for the size of the beam, which is that of `beam` and the head
  HeadOptions beam = {};

  /// kBadOption names every broken field at once; also a replay with `nav`, whose poses are of another time, or
  /// `record`.
  Result<void> validate() const;
};

}  // namespace pingvox
