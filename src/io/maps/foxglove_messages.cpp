#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "io/maps/mcap_writer.hpp"
#include "io/maps/message_parts.hpp"

// docs/formats.md has the fields of the messages; Protobuf's documentation how they are encoded.
namespace pingvox {

std::string occupancy_bytes(const Raster<Occupancy>& slice) {
  constexpr char kFull = 100, kEmpty = 0, kNotKnown = -1;
  std::string bytes;
  bytes.reserve(slice.values.size());
  for (const Occupancy value : slice.values) {
    bytes.push_back(value == Occupancy::kOccupied ? kFull : value == Occupancy::kFree ? kEmpty : kNotKnown);
  }
  return bytes;
}

namespace foxglove {
namespace {

enum class Wire : std::uint8_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };

/// Puts one message together. What is 0 or empty is left out, as proto3 has it.
class ProtoMessage {
 public:
  ProtoMessage& number(std::uint32_t field, std::uint64_t value) {
    if (value == 0) return *this;
    tag(field, Wire::kVarint);
    varint(value);
    return *this;
  }
  ProtoMessage& fixed32(std::uint32_t field, std::uint32_t value) {
    if (value == 0) return *this;
    tag(field, Wire::kFixed32);
    append_little_endian(bytes_, value);
    return *this;
  }
  ProtoMessage& real(std::uint32_t field, double value) {
    if (value == 0.0) return *this;
    tag(field, Wire::kFixed64);
    append_little_endian(bytes_, value);
    return *this;
  }
  ProtoMessage& text(std::uint32_t field, std::string_view value) {
    return value.empty() ? *this : message(field, value);
  }
  /// Also an empty one: it is there then.
  ProtoMessage& message(std::uint32_t field, std::string_view value) {
    tag(field, Wire::kBytes);
    varint(value.size());
    bytes_.append(value);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void tag(std::uint32_t field, Wire wire) { varint(field << 3U | static_cast<std::uint32_t>(wire)); }
  void varint(std::uint64_t value) {
    constexpr std::uint64_t kMore = 0x80;
    for (; value >= kMore; value >>= 7U) bytes_.push_back(static_cast<char>(value | kMore));
    bytes_.push_back(static_cast<char>(value));
  }

  std::string bytes_;
};

struct FieldFacts {
  std::string_view name;
  std::uint32_t number = 0;
  std::string_view type;  ///< a scalar, or the name of a message; [] behind it: repeated
};
struct MessageFacts {
  std::string_view name;
  std::vector<FieldFacts> fields;
};

std::vector<MessageFacts> message_facts() {
  constexpr std::string_view kTime = ".google.protobuf.Timestamp";
  return {
      {"Vector2", {{"x", 1, "double"}, {"y", 2, "double"}}},
      {"Vector3", {{"x", 1, "double"}, {"y", 2, "double"}, {"z", 3, "double"}}},
      {"Quaternion", {{"x", 1, "double"}, {"y", 2, "double"}, {"z", 3, "double"}, {"w", 4, "double"}}},
      {"Pose", {{"position", 1, ".foxglove.Vector3"}, {"orientation", 2, ".foxglove.Quaternion"}}},
      {"PackedElementField",
       {{"name", 1, "string"}, {"offset", 2, "fixed32"}, {"type", 3, ".foxglove.PackedElementField.NumericType"}}},
      {"VoxelGrid",
       {{"timestamp", 1, kTime},
        {"frame_id", 2, "string"},
        {"pose", 3, ".foxglove.Pose"},
        {"row_count", 4, "fixed32"},
        {"column_count", 5, "fixed32"},
        {"cell_size", 6, ".foxglove.Vector3"},
        {"slice_stride", 7, "fixed32"},
        {"row_stride", 8, "fixed32"},
        {"cell_stride", 9, "fixed32"},
        {"fields", 10, ".foxglove.PackedElementField[]"},
        {"data", 11, "bytes"}}},
      {"PointCloud",
       {{"timestamp", 1, kTime},
        {"frame_id", 2, "string"},
        {"pose", 3, ".foxglove.Pose"},
        {"point_stride", 4, "fixed32"},
        {"fields", 5, ".foxglove.PackedElementField[]"},
        {"data", 6, "bytes"}}},
      {"Grid",
       {{"timestamp", 1, kTime},
        {"frame_id", 2, "string"},
        {"pose", 3, ".foxglove.Pose"},
        {"column_count", 4, "fixed32"},
        {"cell_size", 5, ".foxglove.Vector2"},
        {"row_stride", 6, "fixed32"},
        {"cell_stride", 7, "fixed32"},
        {"fields", 8, ".foxglove.PackedElementField[]"},
        {"data", 9, "bytes"}}},
      {"PosesInFrame", {{"timestamp", 1, kTime}, {"frame_id", 2, "string"}, {"poses", 3, ".foxglove.Pose[]"}}},
      {"FrameTransform",
       {{"timestamp", 1, kTime},
        {"parent_frame_id", 2, "string"},
        {"child_frame_id", 3, "string"},
        {"translation", 4, ".foxglove.Vector3"},
        {"rotation", 5, ".foxglove.Quaternion"}}},
  };
}

constexpr std::array<std::string_view, 9> kNumericTypes = {"UNKNOWN", "UINT8", "INT8",    "UINT16", "INT16",
                                                           "UINT32",  "INT32", "FLOAT32", "FLOAT64"};
constexpr std::uint32_t kByteField = 1, kFloatField = 7;

std::string descriptor_of(const MessageFacts& facts) {
  constexpr std::uint32_t kSingle = 1, kRepeated = 3;
  const auto type_number = [](std::string_view type) -> std::uint32_t {
    if (type == "double") return 1;
    if (type == "int64") return 3;
    if (type == "int32") return 5;
    if (type == "fixed32") return 7;
    if (type == "string") return 9;
    if (type == "bytes") return 12;
    return type.ends_with("NumericType") ? 14 : 11;
  };
  ProtoMessage message;
  message.text(1, facts.name);
  for (const FieldFacts& field : facts.fields) {
    const bool is_repeated = field.type.ends_with("[]");
    const std::string_view type = is_repeated ? field.type.substr(0, field.type.size() - 2) : field.type;
    ProtoMessage descriptor;
    descriptor.text(1, field.name).number(3, field.number).number(4, is_repeated ? kRepeated : kSingle);
    descriptor.number(5, type_number(type));
    if (type.starts_with('.')) descriptor.text(6, type);
    message.message(2, descriptor.bytes());
  }
  if (facts.name == "PackedElementField") {
    ProtoMessage numbers;
    numbers.text(1, "NumericType");
    for (std::uint32_t value = 0; value < kNumericTypes.size(); ++value) {
      numbers.message(2, ProtoMessage().text(1, kNumericTypes[value]).number(2, value).bytes());
    }
    message.message(4, numbers.bytes());
  }
  return message.bytes();
}

/// The message and those that its fields are, each once.
void add_needed(std::string_view name, const std::vector<MessageFacts>& all, std::vector<std::string_view>& needed) {
  if (std::ranges::find(needed, name) != needed.end()) return;
  const auto facts = std::ranges::find(all, name, &MessageFacts::name);
  if (facts == all.end()) return;
  needed.push_back(name);
  for (const FieldFacts& field : facts->fields) {
    constexpr std::string_view kPackage = ".foxglove.";
    if (!field.type.starts_with(kPackage)) continue;
    const std::string_view type = field.type.substr(kPackage.size());
    add_needed(type.substr(0, type.find_first_of(".[")), all, needed);
  }
}

std::string timestamp(std::uint32_t seconds, std::uint32_t nanoseconds) {
  return ProtoMessage().number(1, seconds).number(2, nanoseconds).bytes();
}
std::string vector3(const Eigen::Vector3d& vector) {
  return ProtoMessage().real(1, vector.x()).real(2, vector.y()).real(3, vector.z()).bytes();
}
std::string quaternion(const Eigen::Quaterniond& rotation) {
  return ProtoMessage().real(1, rotation.x()).real(2, rotation.y()).real(3, rotation.z()).real(4, rotation.w()).bytes();
}
std::string pose_message(const Pose& pose) {
  return ProtoMessage()
      .message(1, vector3(pose.translation()))
      .message(2, quaternion(Eigen::Quaterniond(pose.rotation())))
      .bytes();
}
Pose corner_at(const Eigen::Vector3d& corner_m) {
  return Pose(Eigen::Translation3d(corner_m));
}

/// Time and frame are the first two fields of most messages.
ProtoMessage stamped(const MessageStamp& stamp) {
  ProtoMessage message;
  message.message(1, timestamp(stamp.seconds(), stamp.nanoseconds())).text(2, stamp.frame);
  return message;
}
std::string packed_field(std::string_view name, std::uint32_t offset, std::uint32_t type) {
  return ProtoMessage().text(1, name).fixed32(2, offset).number(3, type).bytes();
}

}  // namespace

std::string schema_of(std::string_view message) {
  const std::string time_file =
      ProtoMessage()
          .text(1, "google/protobuf/timestamp.proto")
          .text(2, "google.protobuf")
          .message(4, descriptor_of({"Timestamp", {{"seconds", 1, "int64"}, {"nanos", 2, "int32"}}}))
          .text(12, "proto3")
          .bytes();
  const std::vector<MessageFacts> all = message_facts();
  std::vector<std::string_view> needed;
  add_needed(message, all, needed);
  ProtoMessage file;
  file.text(1, "foxglove/" + std::string(message) + ".proto").text(2, "foxglove");
  file.text(3, "google/protobuf/timestamp.proto");
  for (const std::string_view name : needed) {
    file.message(4, descriptor_of(*std::ranges::find(all, name, &MessageFacts::name)));
  }
  file.text(12, "proto3");
  return ProtoMessage().message(1, time_file).message(1, file.bytes()).bytes();
}

std::string voxel_grid(const MessageStamp& stamp, const VoxelBox& box) {
  constexpr std::uint32_t kCell = VoxelBox::kCellBytes;
  ProtoMessage message = stamped(stamp);
  message.message(3, pose_message(corner_at(box.corner_m))).fixed32(4, box.edge).fixed32(5, box.edge);
  message.message(6, vector3(Eigen::Vector3d::Constant(box.cell_m)));
  message.fixed32(7, box.edge * box.edge * kCell).fixed32(8, box.edge * kCell).fixed32(9, kCell);
  message.message(10, packed_field("log_odds", 0, kFloatField));
  constexpr std::array<std::string_view, 4> kChannels = {"red", "green", "blue", "alpha"};
  for (std::uint32_t channel = 0; channel < kChannels.size(); ++channel) {
    message.message(10, packed_field(kChannels[channel], sizeof(float) + channel, kByteField));
  }
  return message.text(11, box.data).bytes();
}

std::string point_cloud(const MessageStamp& stamp, const PackedPoints& points) {
  ProtoMessage message = stamped(stamp);
  message.message(3, pose_message(Pose::Identity())).fixed32(4, static_cast<std::uint32_t>(points.stride()));
  std::uint32_t offset = 0;
  for (const std::string_view field : points.fields) {
    message.message(5, packed_field(field, offset, kFloatField));
    offset += sizeof(float);
  }
  return message.text(6, points.data).bytes();
}

std::string grid(const MessageStamp& stamp, const Raster<Occupancy>& slice) {
  ProtoMessage message = stamped(stamp);
  message.message(3, pose_message(corner_at({slice.corner_m.x(), slice.corner_m.y(), 0.0})));
  message.fixed32(4, static_cast<std::uint32_t>(slice.columns));
  message.message(5, ProtoMessage().real(1, slice.cell_m).real(2, slice.cell_m).bytes());
  message.fixed32(6, static_cast<std::uint32_t>(slice.columns)).fixed32(7, 1);
  return message.message(8, packed_field("occupancy", 0, kByteField)).text(9, occupancy_bytes(slice)).bytes();
}

std::string poses(const MessageStamp& stamp, std::span<const StampedPose> poses) {
  ProtoMessage message = stamped(stamp);
  for (const StampedPose& pose : poses) message.message(3, pose_message(pose.map_from_body));
  return message.bytes();
}

std::string transform(const MessageStamp& parent, std::string_view child, const Pose& parent_from_child) {
  ProtoMessage message = stamped(parent);
  message.text(3, child).message(4, vector3(parent_from_child.translation()));
  return message.message(5, quaternion(Eigen::Quaterniond(parent_from_child.rotation()))).bytes();
}

}  // namespace foxglove
}  // namespace pingvox
