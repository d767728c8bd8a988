#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

// Messages of ROS 2 as CDR (docs/formats.md). Times are in nanoseconds since 1970.
namespace pingvox {

/// A topic that shows a map.
struct Ros2MapTopic {
  std::string_view name, type;
};
/// Those of octomap_server.
inline constexpr std::array kRos2MapTopics = {
    Ros2MapTopic{"/octomap_point_cloud_centers", "sensor_msgs/msg/PointCloud2"},
    Ros2MapTopic{"/projected_map", "nav_msgs/msg/OccupancyGrid"},
    Ros2MapTopic{"/octomap_binary", "octomap_msgs/msg/Octomap"},
    Ros2MapTopic{"/octomap_full", "octomap_msgs/msg/Octomap"},
};

struct Ros2Message {
  std::string_view topic, type;
  std::string bytes;
};

/// The messages of a map, in the order of kRos2MapTopics.
/// @return kUnsupported when nothing is occupied, or the map has other than 16 levels; kLimit when its cells are more
///         than messages can hold
Result<std::vector<Ros2Message>> ros2_map_messages(const OccupancyMap& map, std::uint64_t time_ns,
                                                   std::string_view frame);

/// Velocities in the frame of what moves.
struct Ros2Twist {
  Eigen::Vector3d linear_m_s = Eigen::Vector3d::Zero(), angular_rad_s = Eigen::Vector3d::Zero();
};

/// A nav_msgs/msg/Odometry, whose covariances are zero: not known.
std::string ros2_odometry(std::uint64_t time_ns, std::string_view frame, std::string_view child,
                          const Pose& frame_from_child, const Ros2Twist& twist);
/// A tf2_msgs/msg/TFMessage with one transform.
std::string ros2_transform(std::uint64_t time_ns, std::string_view parent, std::string_view child,
                           const Pose& parent_from_child);

/// As DDS numbers participants and endpoints.
using DdsGuid = std::array<std::uint8_t, 16>;

/// A participant of DDS, all of whose endpoints are those of one node.
struct Ros2ParticipantInfo {
  DdsGuid participant = {};
  std::string node;  ///< its name, in the namespace "/"
  std::vector<DdsGuid> readers, writers;
};
/// How many bytes the graph of ROS has for a GUID: 24 in Humble and before, 16 in Iron and newer.
enum class Ros2GidSize { k16, k24 };
/// An rmw_dds_common/msg/ParticipantEntitiesInfo.
std::string ros2_participant_info(const Ros2ParticipantInfo& info, Ros2GidSize size);

/// As in "RIHS01_9891..."; empty: of a type that is not written.
std::string_view ros2_type_hash(std::string_view type);

}  // namespace pingvox
