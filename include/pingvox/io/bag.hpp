#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/io/nav_fields.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A topic of a ROS bag. Publishers of one topic are counted as one.
struct BagTopicSummary {
  enum class Use { kBeams, kScans, kNavigation, kNone };

  std::string name, type;
  std::size_t messages = 0;
  Use use = Use::kNone;
  std::string fields = {};  ///< numbers in a message that is not used: "x float64, valid bool"; empty: none are known
  std::string other_encoding = {};  ///< of messages that are not read, as in "json"; empty: CDR, or that of ROS 1
  double from_s = 0.0, to_s = 0.0;  ///< when the first and the last message were recorded
  std::string frame = {};           ///< of beams and scans: that of the sensor, as the first message names it
  /// How that frame is mounted by tf.
  struct Mount {
    std::string topic, vehicle;  ///< of tf; the frame of the vehicle: "/tf", "base_link"
    Pose body_from_sensor = Pose::Identity();
  };
  std::optional<Mount> mount = std::nullopt;  ///< nullopt: not in tf
};

/// What a ROS bag holds: its topics in the order in which they were met, and its navigation.
struct BagContents {
  std::vector<BagTopicSummary> topics;
  NavFile nav;
  std::vector<std::string> notes = {};  ///< what could not be used: "/tf: tf does not join base_link to map"
};

/// Reads a bag of ROS 1 or ROS 2 once, one chunk in memory at a time.
/// @param fields  of messages that are read by them, whatever their type
/// @param max_bytes  of messages, after which the rest of the bag is left unread
/// @return kUnsupported when it is none; with Damage::kFail, kCorrupt naming the first damage; kBadOption naming a
///         field that messages lack, and those that they have
Result<BagContents> read_bag(ByteStream stream, Damage damage = Damage::kSkip, std::span<const NavFields> fields = {},
                             std::size_t max_bytes = std::numeric_limits<std::size_t>::max());

/// @return kBadOption naming the first of `fields` whose messages are in none of the topics, and what topics there are
Result<void> check_topics(std::span<const NavFields> fields, std::span<const BagTopicSummary> topics);

}  // namespace pingvox
