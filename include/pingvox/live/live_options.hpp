#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pingvox/device/head_settings.hpp"
#include "pingvox/device/ros2_network.hpp"
#include "pingvox/live/ros2_publish.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/mapping/build_options.hpp"
#include "pingvox/mapping/head_options.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/locate_recording.hpp"
#include "pingvox/slam/slam_smoother.hpp"

namespace pingvox {

/// A sonar head, or a log that is replayed in its place.
struct LiveHead {
  enum class Kind {
    kPing360,
    kMicron,         ///< a SeaNet head: Micron or MiniKing
    kReplay,         ///< a log of beams, at the pace of its times
    kSharedPing360,  ///< a Ping360 at the bridge of BlueOS, driven by another program
    kPingViewer2,    ///< a Ping360 that Ping Viewer 2 drives, by its server
    kRos2,           ///< a head that a node of ROS 2 drives, by a topic of its messages
  };
  Kind kind = Kind::kPing360;
  /// Of a head "udp://192.168.2.2:9092", or a serial port as "/dev/ttyUSB0" or "/dev/ttyUSB0@57600"; of a Micron also
  /// "tcp://HOST:PORT". Of the bridge "udp://HOST:PORT", of Ping Viewer 2 "tcp://HOST:PORT". Of a replay the file.
  /// Of ROS 2 the topic, "/sonar/echo".
  std::string address = {};
  std::string device = {};  ///< of Ping Viewer 2: as it numbers it; empty: the first one that pings
  double speed = 1.0;       ///< of a replay, > 0; infinity: as fast as it can be mapped
  /// How a Ping360 is driven. Of one that another program drives only the range is used, for the cells and obstacles.
  Ping360Settings ping360 = {};
  MicronSettings micron = {};  ///< how a Micron is driven

  /// "ping360:udp://192.168.2.2:9092"
  std::string name() const;
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// A device that reports where the vehicle is.
struct LiveNav {
  enum class Kind {
    kMavlink,  ///< an autopilot that sends MAVLink to "udp://:14550" of this host, or "udp://ADDRESS:14550"
    kA50,      ///< a Water Linked DVL, whose server is "tcp://HOST:16171"
    /// A topic of ROS 2: odometry, poses or messages of navigation sensors, "/odom"; or tf, "/tf", for the pose of the
    /// vehicle in the fixed frame at the root, or that of another frame, "/tf:odom:base_link".
    kRos2,
  };
  Kind kind = Kind::kMavlink;
  std::string address = {};

  Result<void> validate() const;  ///< kBadOption for an address that can never be opened
};

/// A map in which the vehicle is located before it is extended.
struct LiveKnownMap {
  std::string file;
  std::optional<StartPose> start = std::nullopt;  ///< of the vehicle at the first beam; nullopt: anywhere
};

/// Whether LiveMapping::take_changes has anything.
enum class KeepChanges { kNo, kYes };

struct LiveOptions {
  LiveHead head = {};
  /// All are recorded; poses use one position and one attitude. Empty: the vehicle does not move.
  std::vector<LiveNav> nav = {};
  /// The sonar's log, a file that does not exist yet, or a folder, in which it is named by the time. A name without a
  /// suffix is a folder, which is made. The records of `nav` are beside it, with other suffixes. nullopt: no recording.
  std::optional<std::string> record = std::nullopt;
  /// "udp://HOST:PORT" of an autopilot, which is sent the nearest obstacles (MAVLink's OBSTACLE_DISTANCE).
  std::optional<std::string> obstacles = std::nullopt;
  Ros2Network ros2 = {};  ///< of the topics of ROS 2 that are read and published
  /// Topics of ROS 2 that show map and poses. nullopt: none.
  std::optional<Ros2Publish> publish = std::nullopt;
  /// Poses by CausalSlam, from the sonar and the velocity, heading and depth of `nav`, as far as it has them; mount,
  /// filter, echoes and speed of sound are those of `build`. nullopt: no SLAM.
  std::optional<SlamOptions> slam = std::nullopt;
  /// Only with `slam`. Poses are known when the vehicle is located (Localizer), and in the frame of this map; its
  /// depths have to be those of the navigation. nullopt: a new map.
  std::optional<LiveKnownMap> known_map = std::nullopt;
  MapOptions map = {};      ///< of a new map; of a known one the limit of memory alone
  BuildOptions build = {};  ///< but for the size of the beam, which is that of `beam` and the head
  HeadOptions beam = {};
  KeepChanges changes = KeepChanges::kNo;

  bool uses_ros2() const;
  /// kBadOption names every broken field at once; also a replay with `nav`, whose poses are of another time, or
  /// `record`.
  Result<void> validate() const;
};

}  // namespace pingvox
