#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/bags/bag.hpp"
#include "io/bags/ros_message.hpp"

namespace pingvox {

/// How a type of message is known, besides its fields.
enum class RosTypeName {
  kOfType,  ///< by the name of the type without the package: packages are renamed more often than messages
  kOfTopic  ///< in JSON: by the last part of the topic's name, as the schema has the name of a type of its writer
};

/// What a kind of message is: its name, and the fields that we need of it.
struct RosType {
  std::string_view name;
  std::array<std::string_view, 11> fields;  ///< empty ones are none
  std::string_view topic_end = {};          ///< end of the topic's name, for numbers that only it explains
  std::string_view package = {};            ///< for fields that mean something else in one package; empty: any
  RosTypeName named = RosTypeName::kOfType;
};

/// The wanted fields of one message.
class RosFields {
 public:
  RosFields(const RosMessage& message, std::span<const std::size_t> fields) : message_(message), fields_(fields) {}

  double number(std::size_t field, std::size_t i = 0) const { return message_.number(fields_[field], i); }
  float single(std::size_t field) const { return message_.single(fields_[field]); }
  std::size_t count(std::size_t field) const { return message_.count(fields_[field]); }
  std::string_view text(std::size_t field) const { return message_.text(fields_[field]); }
  std::vector<std::uint8_t> bytes(std::size_t field) const { return message_.bytes(fields_[field]); }
  /// Whether a field is an array of bytes.
  bool has_bytes(std::size_t field) const { return !message_.byte_array(fields_[field]).empty(); }

 private:
  const RosMessage& message_;
  std::span<const std::size_t> fields_;
};

/// The name of a frame without the '/' that old drivers begin it with.
std::string_view without_slash(std::string_view frame);

/// A topic of a known type.
struct KnownTopic {
  std::size_t type = 0;  ///< in the table
  std::shared_ptr<const RosLayout> layout;
  std::vector<std::size_t> fields;
  std::optional<std::size_t> stamp_s, stamp_ns;
  std::optional<std::size_t> frame, child;  ///< header.frame_id and child_frame_id

  /// As the message names it; empty: it names none.
  std::string_view frame_of(const RosMessage& message) const { return name_in(message, frame); }
  std::string_view child_of(const RosMessage& message) const { return name_in(message, child); }

  /// nullopt: the message has none.
  std::optional<double> stamp_of(const RosMessage& message) const;
  /// When the message, or a transform in it, was made: its stamp, if that is within a minute of the recording or has a
  /// date where the recording has none; else the recording's time.
  double time_of(const RosMessage& message, double recorded_s) const;

 private:
  static std::string_view name_in(const RosMessage& message, std::optional<std::size_t> field) {
    return field ? without_slash(message.text(*field)) : std::string_view();
  }
};

/// A topic whose messages have these fields, up to the first empty one; nullopt: they lack one.
std::optional<KnownTopic> topic_with(const BagTopic& topic, std::span<const std::string_view> paths);

/// Behind the last slash.
inline std::string_view last_part(std::string_view name) {
  return name.substr(name.rfind('/') + 1);  // npos + 1 is 0
}

/// nullopt: the topic is of none of these types, or has other fields.
template <class Types>
std::optional<KnownTopic> known_topic(const BagTopic& topic, const Types& types) {
  if (!topic.is_readable) return std::nullopt;
  const std::string_view type = topic.type;
  const bool is_json = topic.encoding == RosEncoding::kJson;
  const std::string_view name = last_part(is_json ? topic.name : topic.type);
  for (std::size_t i = 0; i < types.size(); ++i) {
    const RosType& wanted = types[i].type;
    if ((wanted.named == RosTypeName::kOfTopic) != is_json) continue;
    if (name != wanted.name || !topic.name.ends_with(wanted.topic_end) || !type.starts_with(wanted.package)) {
      continue;
    }
    if (auto known = topic_with(topic, wanted.fields)) {
      known->type = i;
      return known;
    }
  }
  return std::nullopt;
}

/// A whole number in its range; nullopt: it is none.
template <class T>
std::optional<T> whole(double number) {
  const bool is_in = number >= std::numeric_limits<T>::min() && number <= std::numeric_limits<T>::max();
  return is_in ? std::optional(static_cast<T>(number)) : std::nullopt;
}

/// Kinds of damage: messages that cannot be used.
inline constexpr std::string_view kNoFit = "message that does not fit its definition",
                                  kImpossible = "impossible values",
                                  kContradiction = "numbers that contradict each other";

/// Why a message cannot be used.
struct Unusable {
  std::string_view kind;  ///< lives as long as the program
  std::string why = {};   ///< with the numbers, as in "1 range does not fit ..."; empty: the kind says all
};

/// The messages of a bag that cannot be used.
class UnusableMessages {
 public:
  void add(const Unusable& message, std::optional<std::uint64_t> file_byte);

  const std::vector<DamageKind>& kinds() const { return kinds_; }
  bool empty() const { return kinds_.empty(); }
  /// Place and reason of the first one, as in "byte 4117: 1 range does not fit ..."; empty: there is none.
  const std::string& first_text() const { return first_text_; }

 private:
  std::vector<DamageKind> kinds_;
  std::string first_text_;
};

/// That of the bag, then its messages that cannot be used.
std::vector<DamageKind> damage_of(const Bag& bag, const UnusableMessages& unusable);
/// Place and reason of the first of them; empty: there is none.
std::string first_damage_of(const Bag& bag, const UnusableMessages& unusable);

/// "/left (sensor_msgs/LaserScan), /right (sensor_msgs/LaserScan)": the topics so far that are of a kind.
std::string topics_text(const Bag& bag, bool (*is_of_kind)(const BagTopic&));

/// The error where nothing says which topic is meant. @param what  that they hold: "beams"
tl::unexpected<Error> several_topics(const Bag& bag, std::string_view what, bool (*is_of_kind)(const BagTopic&));

/// What is said of a topic whose stamps stand still (StampWatch).
std::string note_of_stamps(std::string_view topic);
/// Two notes as one, of which each may be empty.
std::string joined_notes(std::string one, const std::string& other);

}  // namespace pingvox
