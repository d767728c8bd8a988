#include "io/internal/ros2_messages.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <sstream>
#include <utility>

#include "io/maps/mcap_writer.hpp"
#include "io/maps/message_parts.hpp"
#include "io/maps/occupied_leaves.hpp"
#include "pingvox/analysis/slice.hpp"
#include "pingvox/io/maps.hpp"

// docs/formats.md has the fields of the messages and how CDR encodes them.
namespace pingvox::ros2 {
namespace {

/// Puts a message together: numbers at multiples of their size, counted from behind the first four bytes.
class CdrMessage {
 public:
  CdrMessage() : bytes_("\0\1\0\0", kHeader) {}

  template <class T>
  CdrMessage& number(T value) {
    while ((bytes_.size() - kHeader) % sizeof(T) != 0) bytes_.push_back('\0');
    append_little_endian(bytes_, value);
    return *this;
  }
  CdrMessage& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.append(value);
    bytes_.push_back('\0');
    return *this;
  }
  CdrMessage& sequence(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_.append(value);
    return *this;
  }
  CdrMessage& header(const MessageStamp& stamp) {
    number(static_cast<std::int32_t>(stamp.seconds())).number(stamp.nanoseconds());
    return text(stamp.frame);
  }
  CdrMessage& pose(const Pose& pose) {
    for (const double value : pose.translation()) number(value);
    const Eigen::Quaterniond rotation(pose.rotation());
    for (const double value : {rotation.x(), rotation.y(), rotation.z(), rotation.w()}) number(value);
    return *this;
  }
  CdrMessage& gid(const DdsGuid& guid, Ros2GidSize size) {
    constexpr std::size_t kBytesOfHumble = 24;
    for (const std::uint8_t byte : guid) number(byte);
    if (size == Ros2GidSize::k24) bytes_.append(kBytesOfHumble - guid.size(), '\0');
    return *this;
  }
  CdrMessage& gids(const std::vector<DdsGuid>& guids, Ros2GidSize size) {
    number(static_cast<std::uint32_t>(guids.size()));
    for (const DdsGuid& guid : guids) gid(guid, size);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  static constexpr std::size_t kHeader = 4;
  std::string bytes_;
};

struct RosType {
  std::string_view name;  ///< without /msg/
  std::string_view text;
  std::vector<std::string_view> needs;
  std::string_view hash;
};

std::vector<RosType> ros_types() {
  const std::vector<std::string_view> pose_needs = {"std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Pose",
                                                    "geometry_msgs/Point", "geometry_msgs/Quaternion"};
  return {
      {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n", {}, {}},
      {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n", {}, {}},
      {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n", {}, {}},
      {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n", {}, {}},
      {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n", {}, {}},
      {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n", {}, {}},
      {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n", {}, {}},
      {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n", {}, {}},
      {"geometry_msgs/TransformStamped",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
       {},
       {}},
      {"sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count\n", {}, {}},
      {"nav_msgs/MapMetaData",
       "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n"
       "geometry_msgs/Pose origin\n",
       {},
       {}},
      {"octomap_msgs/Octomap",
       "std_msgs/Header header\nbool binary\nstring id\nfloat64 resolution\nint8[] data\n",
       {"std_msgs/Header", "builtin_interfaces/Time"},
       "RIHS01_9891a19a05b70ec20aa8f45db3f8300b9ab80afff32c61c549d25087da9625b0"},
      {"sensor_msgs/PointCloud2",
       "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n"
       "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
       {"std_msgs/Header", "builtin_interfaces/Time", "sensor_msgs/PointField"},
       "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
      {"nav_msgs/OccupancyGrid",
       "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n",
       {"std_msgs/Header", "builtin_interfaces/Time", "nav_msgs/MapMetaData", "geometry_msgs/Pose",
        "geometry_msgs/Point", "geometry_msgs/Quaternion"},
       "RIHS01_8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"},
      {"nav_msgs/Odometry", {}, {}, "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
      {"nav_msgs/Path",
       "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
       {"std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/PoseStamped", "geometry_msgs/Pose",
        "geometry_msgs/Point", "geometry_msgs/Quaternion"},
       "RIHS01_1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b"},
      {"tf2_msgs/TFMessage",
       "geometry_msgs/TransformStamped[] transforms\n",
       {"geometry_msgs/TransformStamped", "std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Transform",
        "geometry_msgs/Vector3", "geometry_msgs/Quaternion"},
       "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
  };
}

/// "octomap_msgs/msg/Octomap" -> "octomap_msgs/Octomap"
std::string short_name(std::string_view type) {
  std::string name(type);
  constexpr std::string_view kPart = "/msg/";
  if (const std::size_t at = name.find(kPart); at != std::string::npos) name.replace(at, kPart.size(), "/");
  return name;
}

}  // namespace

std::string schema_of(std::string_view type) {
  constexpr std::size_t kRule = 80;
  const std::vector<RosType> types = ros_types();
  const auto named = [&](std::string_view name) { return std::ranges::find(types, name, &RosType::name); };
  const auto found = named(short_name(type));
  if (found == types.end()) return {};
  std::string text(found->text);
  for (const std::string_view need : found->needs) {
    text += std::string(kRule, '=') + "\nMSG: " + std::string(need) + "\n" + std::string(named(need)->text);
  }
  return text;
}

std::string_view hash_of(std::string_view type) {
  const std::vector<RosType> types = ros_types();
  const auto found = std::ranges::find(types, short_name(type), &RosType::name);
  return found == types.end() ? std::string_view() : found->hash;
}

std::string octomap(const MessageStamp& stamp, bool is_binary, double resolution_m, std::string_view tree) {
  CdrMessage message;
  message.header(stamp).number(static_cast<std::uint8_t>(is_binary)).text("OcTree").number(resolution_m);
  return message.sequence(tree).bytes();
}

std::string point_cloud(const MessageStamp& stamp, const PackedPoints& points) {
  constexpr std::uint8_t kFloat = 7;
  const auto bytes = static_cast<std::uint32_t>(points.data.size());
  const auto stride = static_cast<std::uint32_t>(points.stride());
  CdrMessage message;
  message.header(stamp).number(std::uint32_t{1}).number(bytes / stride);
  message.number(static_cast<std::uint32_t>(points.fields.size()));
  std::uint32_t offset = 0;
  for (const std::string_view field : points.fields) {
    message.text(field).number(offset).number(kFloat).number(std::uint32_t{1});
    offset += sizeof(float);
  }
  message.number(std::uint8_t{0}).number(stride).number(bytes).sequence(points.data);
  return message.number(std::uint8_t{1}).bytes();
}

std::string grid(const MessageStamp& stamp, const Raster<Occupancy>& slice) {
  CdrMessage message;
  message.header(stamp).number(static_cast<std::int32_t>(stamp.seconds())).number(stamp.nanoseconds());
  message.number(static_cast<float>(slice.cell_m)).number(static_cast<std::uint32_t>(slice.columns));
  message.number(static_cast<std::uint32_t>(slice.rows));
  message.pose(Pose(Eigen::Translation3d(slice.corner_m.x(), slice.corner_m.y(), 0.0)));
  return message.sequence(occupancy_bytes(slice)).bytes();
}

std::string poses(const MessageStamp& stamp, std::span<const StampedPose> poses) {
  CdrMessage message;
  message.header(stamp).number(static_cast<std::uint32_t>(poses.size()));
  for (const StampedPose& pose : poses) {
    const auto time_ns = static_cast<std::uint64_t>(pose.time_s * static_cast<double>(MessageStamp::kSecond_ns));
    message.header({time_ns, stamp.frame}).pose(pose.map_from_body);
  }
  return message.bytes();
}

std::string odometry(const MessageStamp& parent, std::string_view child, const Pose& parent_from_child,
                     const Ros2Twist& twist) {
  constexpr int kCovariances = 36;
  CdrMessage message;
  message.header(parent).text(child).pose(parent_from_child);
  for (int i = 0; i < kCovariances; ++i) message.number(0.0);
  for (const double value : twist.linear_m_s) message.number(value);
  for (const double value : twist.angular_rad_s) message.number(value);
  for (int i = 0; i < kCovariances; ++i) message.number(0.0);
  return message.bytes();
}

std::string transform(const MessageStamp& parent, std::string_view child, const Pose& parent_from_child) {
  CdrMessage message;
  return message.number(std::uint32_t{1}).header(parent).text(child).pose(parent_from_child).bytes();
}

std::string participant_info(const Ros2ParticipantInfo& info, Ros2GidSize size) {
  CdrMessage message;
  message.gid(info.participant, size).number(std::uint32_t{1}).text("/").text(info.node);
  return message.gids(info.readers, size).gids(info.writers, size).bytes();
}

}  // namespace pingvox::ros2

namespace pingvox {
namespace {

/// What is behind the header of a .bt or .ot.
Result<std::string> tree_of(const OccupancyMap& map, Format format) {
  constexpr std::string_view kEnd = "\ndata\n";
  std::ostringstream file;
  if (const Result<void> written = write_map(map, format, {}, file); !written) return tl::unexpected(written.error());
  std::string text = std::move(file).str();
  text.erase(0, text.find(kEnd) + kEnd.size());
  return text;
}

}  // namespace

Result<PackedPoints> occupied_points(const OccupancyMap& map) {
  PackedPoints points{{"x", "y", "z", "log_odds", "size"}, {}};
  for_each_occupied(map, [&](const Leaf& leaf) {
    for (const double value : leaf.centre_m()) append_little_endian(points.data, static_cast<float>(value));
    append_little_endian(points.data, leaf.belief.value());
    append_little_endian(points.data, static_cast<float>(leaf.edge_m()));
  });
  if (points.data.empty()) return fail(Error::Code::kUnsupported, "no cell is occupied: there is nothing to show");
  if (points.data.size() > std::numeric_limits<std::uint32_t>::max()) {
    return fail(Error::Code::kLimit, "its points are more than 4 GB");
  }
  return points;
}

Result<std::vector<Ros2Message>> ros2_map_messages(const OccupancyMap& map, std::uint64_t time_ns,
                                                   std::string_view frame) {
  const MessageStamp stamp{time_ns, frame};
  const Result<Raster<Occupancy>> slice = slice_of(map, {});
  if (!slice) return tl::unexpected(slice.error());
  const Result<PackedPoints> points = occupied_points(map);
  if (!points) return tl::unexpected(points.error());
  const Result<std::string> binary = tree_of(map, Format::kBt);
  if (!binary) return tl::unexpected(binary.error());
  const Result<std::string> full = tree_of(map, Format::kOt);
  if (!full) return tl::unexpected(full.error());
  const double resolution_m = map.lattice().resolution_m();
  std::vector<Ros2Message> messages;
  for (std::string bytes :
       {ros2::point_cloud(stamp, *points), ros2::grid(stamp, *slice), ros2::octomap(stamp, true, resolution_m, *binary),
        ros2::octomap(stamp, false, resolution_m, *full)}) {
    const Ros2MapTopic& topic = kRos2MapTopics[messages.size()];
    messages.push_back({topic.name, topic.type, std::move(bytes)});
  }
  return messages;
}

std::string ros2_odometry(std::uint64_t time_ns, std::string_view frame, std::string_view child,
                          const Pose& frame_from_child, const Ros2Twist& twist) {
  return ros2::odometry({time_ns, frame}, child, frame_from_child, twist);
}

std::string ros2_transform(std::uint64_t time_ns, std::string_view parent, std::string_view child,
                           const Pose& parent_from_child) {
  return ros2::transform({time_ns, parent}, child, parent_from_child);
}

std::string ros2_participant_info(const Ros2ParticipantInfo& info, Ros2GidSize size) {
  return ros2::participant_info(info, size);
}

std::string_view ros2_type_hash(std::string_view type) {
  return ros2::hash_of(type);
}

}  // namespace pingvox
