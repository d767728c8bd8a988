#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/internal/ros2_messages.hpp"
#include "pingvox/analysis/slice.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

// What messages of Foxglove and of ROS 2 hold, whichever of the two they are.
namespace pingvox {

/// Of a message: when [ns] and in which frame.
struct MessageStamp {
  std::uint64_t time_ns = 0;
  std::string_view frame;

  std::uint32_t seconds() const { return static_cast<std::uint32_t>(time_ns / kSecond_ns); }
  std::uint32_t nanoseconds() const { return static_cast<std::uint32_t>(time_ns % kSecond_ns); }

  static constexpr std::uint64_t kSecond_ns = 1'000'000'000;
};

/// Points whose fields all are floats.
struct PackedPoints {
  std::vector<std::string_view> fields;
  std::string data;

  std::size_t stride() const { return fields.size() * sizeof(float); }
};

/// The centres of the occupied cells, with log-odds and edge. kUnsupported when there are none, kLimit for more than
/// messages can hold.
Result<PackedPoints> occupied_points(const OccupancyMap& map);

/// A dense box of cells with their log-odds and colour: x fastest, then y, then z.
struct VoxelBox {
  static constexpr std::size_t kCellBytes = 8;
  Eigen::Vector3d corner_m = Eigen::Vector3d::Zero();
  double cell_m = 0.0;
  std::uint32_t edge = 0;  ///< cells along each axis
  std::string data;        ///< of each cell log-odds (float), red, green, blue, alpha
};

/// The bytes of occupancy of a raster: 100 occupied, 0 free, 255 (-1) unknown; the lowest row first.
std::string occupancy_bytes(const Raster<Occupancy>& slice);

/// Messages of Foxglove as Protobuf, and what describes them: a FileDescriptorSet.
namespace foxglove {
std::string schema_of(std::string_view message);
std::string voxel_grid(const MessageStamp& stamp, const VoxelBox& box);
std::string point_cloud(const MessageStamp& stamp, const PackedPoints& points);
std::string grid(const MessageStamp& stamp, const Raster<Occupancy>& slice);
std::string poses(const MessageStamp& stamp, std::span<const StampedPose> poses);
std::string transform(const MessageStamp& parent, std::string_view child, const Pose& parent_from_child);
}  // namespace foxglove

/// Messages of ROS 2 as CDR, and what describes them: the text of their definition.
namespace ros2 {
/// @param type  as "octomap_msgs/msg/Octomap"
std::string schema_of(std::string_view type);
/// As RIHS01 has it.
std::string_view hash_of(std::string_view type);
/// @param tree  what is behind the header of a .bt or .ot
std::string octomap(const MessageStamp& stamp, bool is_binary, double resolution_m, std::string_view tree);
std::string point_cloud(const MessageStamp& stamp, const PackedPoints& points);
std::string grid(const MessageStamp& stamp, const Raster<Occupancy>& slice);
std::string poses(const MessageStamp& stamp, std::span<const StampedPose> poses);
std::string odometry(const MessageStamp& parent, std::string_view child, const Pose& parent_from_child,
                     const Ros2Twist& twist);
std::string transform(const MessageStamp& parent, std::string_view child, const Pose& parent_from_child);
std::string participant_info(const Ros2ParticipantInfo& info, Ros2GidSize size);
}  // namespace ros2

}  // namespace pingvox
