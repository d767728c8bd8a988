#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/internal/tf_frames.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

// Messages of ROS 2 that are read as they come, as those of bags are (docs/formats.md).
namespace pingvox {

/// A message in CDR, and when it came [s since 1970].
struct Ros2Arrival {
  double time_s = 0.0;
  std::string bytes;
};
/// Waits for the next message of a topic. nullopt: the end.
using NextRos2Arrival = std::function<std::optional<Ros2Arrival>()>;

/// The beams in the messages of a sonar's driver: a beam has the stamp of its message, where that is within a minute of
/// its arrival. Messages that cannot be used are counted as damage; a scan in many directions ends the beams,
/// kUnsupported, where it comes before any beam.
/// @param type  as in "ping360_sonar_msgs/msg/SonarEcho"
/// @return kUnsupported where it is none of a sonar, or one whose definition is only in bags
Result<std::unique_ptr<BeamSource>> read_ros2_beams(const std::string& topic, const std::string& type,
                                                    NextRos2Arrival next);
/// The head whose driver has messages of this type; nullptr: any.
const DeviceProfile* device_of_ros2_type(const std::string& type);

/// The samples in a message of navigation that came at this time [s since 1970]. Of an attitude that it should have and
/// does not, a source without samples, whose fault is why.
/// @return kCorrupt for one that is damaged, kUnsupported, with the reason, while such messages give nothing
using ReadRos2Nav = std::function<Result<std::vector<NavSource>>(std::string_view message, double time_s)>;
/// Of a topic that is the vehicle's: odometry, poses, velocities, Imus, fixes.
/// @return kUnsupported where the type is none of these, or one whose definition is only in bags
Result<ReadRos2Nav> read_ros2_nav(const std::string& topic, const std::string& type);

/// Whether a topic is one of tf, whose transforms move.
bool is_ros2_tf(const std::string& topic, const std::string& type);
/// Of tf, the poses of the vehicle, as the source "/tf:map:base_link". New poses are returned every tenth of a
/// second.
struct ReadRos2Tf {
  ReadRos2Nav moving;  ///< of the topic
  ReadRos2Nav still;   ///< of the topic of its static transforms; gives nothing by itself
};
/// REQUIRES is_ros2_tf.
/// @param frames  of the poses; nullopt: of the one vehicle in the fixed frame at the root, by their names as in bags,
///                as they are after two seconds
ReadRos2Tf read_ros2_tf(const std::string& topic, const std::string& type, const std::optional<TfFrames>& frames);

}  // namespace pingvox
