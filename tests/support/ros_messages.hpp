#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "bag_writer.hpp"

// Messages of ROS 2 for tests, in CDR.
namespace pingvox::bags {

/// A message as it grows.
class Cdr {
 public:
  template <class T>
  Cdr& number(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back(0);
    put(bytes_, value);
    return *this;
  }
  Cdr& numbers(const std::vector<double>& values) {
    for (const double value : values) number(value);
    return *this;
  }
  Cdr& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
    return *this;
  }
  Cdr& header(double time_s, std::string_view frame) {
    const double whole_s = std::floor(time_s);
    number(static_cast<std::int32_t>(whole_s));
    number(static_cast<std::uint32_t>(std::lround((time_s - whole_s) * 1e9)));
    return text(frame);
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_ = {0, 1, 0, 0};
};

/// Place, and rotation as x, y, z, w, of a vehicle that is level or, with roll pi, on its back.
inline std::vector<double> pose_numbers(double x, double y, double z, double yaw_rad, bool is_on_its_back = false) {
  const double s = std::sin(yaw_rad / 2.0), c = std::cos(yaw_rad / 2.0);
  if (is_on_its_back) return {x, y, z, c, s, 0.0, 0.0};
  return {x, y, z, 0.0, 0.0, s, c};
}

inline Bytes odometry(double time_s, std::string_view frame, std::string_view child, const std::vector<double>& pose,
                      const std::vector<double>& velocity = {0.0, 0.0, 0.0}) {
  Cdr message;
  message.header(time_s, frame).text(child).numbers(pose).numbers(std::vector<double>(36)).numbers(velocity);
  message.numbers(std::vector<double>(3 + 36));
  return message.bytes();
}

inline Bytes pose_stamped(double time_s, std::string_view frame, const std::vector<double>& pose) {
  return Cdr().header(time_s, frame).numbers(pose).bytes();
}

inline Bytes twist_stamped(double time_s, std::string_view frame, const std::vector<double>& linear_and_angular) {
  return Cdr().header(time_s, frame).numbers(linear_and_angular).bytes();
}

inline Bytes imu(double time_s, std::string_view frame, const std::vector<double>& rotation,
                 const std::vector<double>& rate, double upward_m_s2 = 0.0) {
  Cdr message;
  message.header(time_s, frame).numbers(rotation).numbers(std::vector<double>(9)).numbers(rate);
  message.numbers(std::vector<double>(9)).numbers({0.0, 0.0, upward_m_s2});
  return message.numbers(std::vector<double>(9)).bytes();
}

inline Bytes nav_sat_fix(double time_s, double latitude_deg, double longitude_deg) {
  Cdr message;
  message.header(time_s, "gps").number(std::int8_t{0}).number(std::uint16_t{1});
  message.numbers({latitude_deg, longitude_deg, 0.0}).numbers(std::vector<double>(9));
  return message.number(std::uint8_t{0}).bytes();
}

/// A transform of tf.
struct Transform {
  std::string_view parent, child;
  std::vector<double> pose;
};
inline Bytes transforms(double time_s, const std::vector<Transform>& all) {
  Cdr message;
  message.number(static_cast<std::uint32_t>(all.size()));
  for (const Transform& one : all) message.header(time_s, one.parent).text(one.child).numbers(one.pose);
  return message.bytes();
}

/// An echo of a Ping360 in a frame, of 20 bins in 2 m with an echo in one of them.
inline Bytes sonar_echo(double time_s, std::string_view frame, float angle_rad, std::size_t echo_bin) {
  constexpr std::uint32_t kBins = 20;
  Cdr message;
  message.header(time_s, frame).number(angle_rad).number(std::uint8_t{1}).number(static_cast<std::uint16_t>(kBins));
  message.number(std::uint16_t{750}).number(std::uint16_t{1500}).number(std::uint8_t{2}).number(kBins);
  for (std::uint32_t i = 0; i < kBins; ++i) message.number(static_cast<std::uint8_t>(i == echo_bin ? 200 : 2));
  return message.bytes();
}

inline std::uint64_t nanoseconds(double time_s) {
  return static_cast<std::uint64_t>(std::llround(time_s * 1e9));
}

}  // namespace pingvox::bags
