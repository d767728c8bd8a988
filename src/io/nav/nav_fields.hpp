#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/bags/bag_topics.hpp"
#include "io/bags/ros_message.hpp"
#include "io/nav/nav_sources.hpp"
#include "pingvox/io/nav_fields.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Roll, pitch, yaw of a rotation.
Eigen::Vector3d rpy_of(const Eigen::Matrix3d& r);

/// Rotation by a quaternion x, y, z, w; nullopt: it is none. Drivers without an attitude send zeros.
std::optional<Eigen::Quaterniond> rotation_of_quaternion(const Eigen::Vector4d& xyzw);
/// Its roll, pitch, yaw.
std::optional<Eigen::Vector3d> rpy_of_quaternion(const Eigen::Vector4d& xyzw);

/// Whether a topic's messages are those of the mapping.
bool is_of(const NavFields& fields, std::string_view topic, std::string_view type);

/// The fields of a mapping, found in a type of message.
class NavReader {
 public:
  /// @return kBadOption naming the field that the messages lack or that is no number, and those that they have
  static Result<NavReader> make(const NavFields& fields, const RosLayout& layout);

  /// Adds the sample of a message, unless one of its numbers is missing.
  /// @param origin  by the message's names of frames; not used where the mapping says what the frame is
  void add(const RosMessage& message, const KnownTopic& topic, double recorded_s, const std::string& source,
           NavSources& sources, const NavOrigin& origin) const;

 private:
  struct Number {
    std::size_t field = 0, i = 0;
    double sign = 1.0;
    double in(const RosMessage& message) const { return sign * message.number(field, i); }
  };
  struct Condition {
    Number number;
    std::string_view comparison;
    double with = 0.0;
  };
  class Finder;

  Eigen::Vector3d value_in(const RosMessage& message) const;
  Eigen::Vector3d deviation_in(const RosMessage& message) const;
  bool is_valid(const RosMessage& message) const;

  NavQuantity quantity_ = NavQuantity::kVelocity;
  NavFields::Frame frame_ = NavFields::Frame::kByName;
  NavFields::Spread spread_is_ = NavFields::Spread::kDeviation;
  double unit_ = 1.0, time_unit_s_ = 1.0;
  std::vector<Number> values_, spread_;
  std::optional<Condition> valid_;
  bool is_received_ = false;
  std::vector<Number> time_;  ///< one number; of a time its seconds and nanoseconds; none: by the stamp
};

}  // namespace pingvox
