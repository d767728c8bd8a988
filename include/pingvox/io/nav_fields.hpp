#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// How messages of a ROS bag hold one quantity of navigation (docs/formats.md). Their numbers are named by paths, as in
/// "velocity.x" or "covariance[7]"; a minus before a path turns the sign.
struct NavFields {
  enum class Frame {
    kByName,  ///< by the messages' frame_id (nav_frames.hpp): kEnu where it names no convention
    kEnu,     ///< ROS REP-103: x ahead, y left, z up in x east, y north, z up
    kNed      ///< forward, right, down in north, east, down
  };
  enum class Spread { kDeviation, kVariance };
  /// Value of `time`: when the message was recorded.
  static constexpr std::string_view kReceived = "received";

  std::string topic, type;  ///< of the messages; one of them may be empty: any
  NavQuantity quantity = NavQuantity::kVelocity;
  /// As many as the quantity has numbers. An attitude may be a quaternion x, y, z, w; the third number of a velocity, a
  /// position or a fix may be left out: 0.
  std::vector<std::string> values;
  double unit = 1.0;  ///< of the values (of a fix: of its angles), in that of the quantity
  Frame frame = Frame::kByName;
  std::vector<std::string> spread;  ///< one for all numbers, or one for each, in `unit`; empty: not known
  Spread spread_is = Spread::kDeviation;
  std::string valid;  ///< "PATH": not valid where it is 0; "PATH >= 1" (also >, <, <=, ==, !=); empty: always valid
  /// Path of a time, or of a number of `time_unit_s`; empty: the message's stamp, if that is within a minute of when it
  /// was recorded, else the latter.
  std::string time;
  double time_unit_s = 1.0;
  std::string stated_in = {};  ///< for messages: "dvl.toml: line 7"

  /// Whether the numbers of fields fit the quantity, and the units are above 0.
  Result<void> validate() const;
};

/// Whether frames matter to a quantity.
bool has_frame(NavQuantity quantity);

}  // namespace pingvox
