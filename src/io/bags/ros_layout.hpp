#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// What the messages of a topic are made of, by the text of their definition, or by the first of them in JSON
// (docs/formats.md).
namespace pingvox {

/// How messages are written as bytes.
enum class RosEncoding {
  kRos1,  ///< packed, little-endian
  kCdr,   ///< of ROS 2: aligned, in the byte order that the message names
  kJson   ///< text with the names of its fields
};

enum class RosNumber : std::uint8_t { kI8, kU8, kI16, kU16, kI32, kU32, kI64, kU64, kF32, kF64, kText };

/// Bytes of a number, or of a character of text.
constexpr std::size_t size_of(RosNumber type) {
  switch (type) {
    case RosNumber::kI8:
    case RosNumber::kU8:
    case RosNumber::kText:
      return 1;
    case RosNumber::kI16:
    case RosNumber::kU16:
      return 2;
    case RosNumber::kI32:
    case RosNumber::kU32:
    case RosNumber::kF32:
      return 4;
    default:
      return 8;
  }
}

/// The next multiple of `alignment`.
constexpr std::size_t align(std::size_t offset, std::size_t alignment) {
  return (offset + alignment - 1) / alignment * alignment;
}

/// A field of numbers or text.
struct RosField {
  std::string path;  ///< as in "header.stamp.sec"
  std::string type;  ///< as in the definition: "float64", "uint8[]"; "float32[][3]" within an array
  std::optional<std::size_t> size = std::nullopt;  ///< of an array that is fixed; nullopt: another field

  bool is_array() const { return type.ends_with(']'); }
  bool is_text() const { return type.starts_with("string"); }
};

/// The fields of a type of message: those of messages in it have paths, as in "header.stamp.sec".
class RosLayout {
 public:
  /// @param type        as in "sensor_msgs/Imu" or "sensor_msgs/msg/Imu"
  /// @param definition  its text, with those of the messages in it; may be empty for common types of ROS 2
  /// @return nullopt when a type is not defined, or the definition has no end
  static std::optional<RosLayout> make(std::string_view type, std::string_view definition, RosEncoding encoding);

  /// The fields of a message in JSON, which are taken for those of all messages of its topic. What is null has the type
  /// of a number, since that is how numbers that are not finite are written. nullopt: it is no object in JSON.
  static std::optional<RosLayout> of_json(std::string_view message);

  /// The number of a field; nullopt: there is none of that path.
  std::optional<std::size_t> field(std::string_view path) const;
  const std::vector<RosField>& fields() const { return fields_; }
  RosEncoding encoding() const { return encoding_; }

 private:
  friend class RosMessage;
  friend class LayoutMaker;
  friend class JsonFields;
  enum class Array : std::uint8_t { kNone, kFixed, kVariable };

  struct Member {
    Array array = Array::kNone;
    std::size_t size = 1;  ///< of a fixed array
    RosNumber type = RosNumber::kU8;
    std::size_t field = 0;              ///< of a number or text
    std::optional<std::size_t> record;  ///< of a message in this one, in records_
  };
  /// A number in a record of fixed size.
  struct Place {
    std::size_t field, offset, count;
    RosNumber type;
  };
  struct Record {
    std::vector<Member> members;
    bool is_fixed = false;             ///< each has the same size and places; it begins at a multiple of `alignment`
    bool is_fixed_if_aligned = false;  ///< the same, where the first one begins at a multiple of `alignment`
    std::size_t size = 0, alignment = 1;
    std::vector<Place> places;
  };

  RosEncoding encoding_ = RosEncoding::kRos1;
  std::vector<Record> records_;  ///< the last one is the message
  std::vector<RosField> fields_;
  std::map<std::string, std::size_t, std::less<>> json_fields_;  ///< of messages in JSON, by path
};

/// RosLayout::make for topics that share it; nullptr for nullopt.
std::shared_ptr<const RosLayout> shared_layout(std::string_view type, std::string_view definition,
                                               RosEncoding encoding);

/// The numbers of a message, without those of its header: "x float64, valid bool".
std::string fields_text(const RosLayout& layout);

}  // namespace pingvox
