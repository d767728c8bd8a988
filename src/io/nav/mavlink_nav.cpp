#include "io/internal/mavlink_nav.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "io/bytes/byte_reader.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"

namespace pingvox {
namespace {

using Report = MavlinkNav::Report;

/// Messages that `Message::read` knows.
constexpr std::array<std::uint32_t, 14> kConverted = {24, 29, 30, 31, 32, 33, 74, 102, 132, 137, 143, 178, 232, 11011};

/// Fields of a payload, by their offset.
class Fields {
 public:
  explicit Fields(const MavlinkFrame& frame) : payload_(frame.payload) {}
  template <class T>
  T at(std::size_t offset) const {
    return value_from<T>(payload_.subspan(offset, sizeof(T)), std::endian::little);
  }
  /// Three numbers, one behind the other.
  template <class T>
  Eigen::Vector3d three(std::size_t offset) const {
    return {static_cast<double>(at<T>(offset)), static_cast<double>(at<T>(offset + sizeof(T))),
            static_cast<double>(at<T>(offset + 2 * sizeof(T)))};
  }

 private:
  std::span<const std::uint8_t> payload_;
};

NavSample sample_of(const Eigen::Vector3d& value) {
  NavSample sample;
  sample.value = value;
  return sample;
}

/// A position of the autopilot's filter, which is 0, 0 until it is known.
NavSample position_of(const Eigen::Vector3d& north_east_down) {
  NavSample sample = sample_of(from_ned::world(north_east_down));
  sample.valid = north_east_down.x() != 0.0 || north_east_down.y() != 0.0;
  return sample;
}

/// A fix of integers of 1e-7 degrees; 0, 0 comes from a receiver without satellites.
NavSample fix_of(std::int32_t latitude, std::int32_t longitude, double altitude_m) {
  NavSample sample = sample_of({latitude * 1e-7 * kDegree_rad, longitude * 1e-7 * kDegree_rad, altitude_m});
  sample.valid = latitude != 0 || longitude != 0;
  return sample;
}

/// Reads one message.
class Message {
 public:
  Message(const MavlinkFrame& frame, double received_s, DeviceClock& clock)
      : clock_(clock), sender_(frame.system, frame.component), received_s_(received_s), time_s_(received_s) {
    // The autopilot's own messages need no address behind their name.
    if (sender_ != MavlinkNav::Sender(1, 1)) address_ = fmt::format(" {}/{}", frame.system, frame.component);
    read(frame.message, Fields(frame));
  }

  std::vector<Report> take() { return std::move(reports_); }

 private:
  void put(const std::string& name, NavQuantity quantity, const NavSample& sample) {
    if (!sample.value.allFinite()) return;
    Report report{name + address_, quantity, sample, made_};
    report.sample.time_s = time_s_;
    reports_.push_back(std::move(report));
  }

  /// The message says itself when it was made; 0: it does not.
  void has_boot_time(std::uint32_t boot_ms) {
    if (boot_ms == 0) return;
    made_ = MavlinkNav::Made{sender_, {received_s_, boot_ms * 1e-3}};
    time_s_ = clock_.add(made_->time);
  }

  void read(std::uint32_t message, const Fields& fields) {
    using enum NavQuantity;
    switch (message) {
      case 24:
        return put("GPS_RAW_INT", kFix,
                   with_validity(fix_of(fields.at<std::int32_t>(8), fields.at<std::int32_t>(12),
                                        fields.at<std::int32_t>(16) * 1e-3),
                                 fields.at<std::uint8_t>(28) >= 2));
      case 29:
        return add_pressure("SCALED_PRESSURE", fields);
      case 137:
        return add_pressure("SCALED_PRESSURE2", fields);
      case 143:
        return add_pressure("SCALED_PRESSURE3", fields);
      case 30:
        has_boot_time(fields.at<std::uint32_t>(0));
        put("ATTITUDE", kAttitude, sample_of(from_ned::attitude(fields.three<float>(4))));
        return put("ATTITUDE", kTurnRate, sample_of(from_ned::body(fields.three<float>(16))));
      case 31:
        return add_quaternion(fields);
      case 32:
        has_boot_time(fields.at<std::uint32_t>(0));
        return put("LOCAL_POSITION_NED", kPosition, position_of(fields.three<float>(4)));
      case 33:
        has_boot_time(fields.at<std::uint32_t>(0));
        put("GLOBAL_POSITION_INT", kDepth, sample_of({fields.at<std::int32_t>(16) * -1e-3, 0, 0}));
        return put("GLOBAL_POSITION_INT", kFix,
                   fix_of(fields.at<std::int32_t>(4), fields.at<std::int32_t>(8), fields.at<std::int32_t>(12) * 1e-3));
      case 74:
        return put("VFR_HUD", kHeading, sample_of({from_ned::yaw(fields.at<std::int16_t>(16) * kDegree_rad), 0, 0}));
      case 102:
        put("VISION_POSITION_ESTIMATE", kPosition, sample_of(from_ned::world(fields.three<float>(8))));
        return put("VISION_POSITION_ESTIMATE", kAttitude, sample_of(from_ned::attitude(fields.three<float>(20))));
      case 132:
        return add_distance(fields);
      case 178:
        return put("AHRS2", kAttitude, sample_of(from_ned::attitude(fields.three<float>(0))));
      case 232:
        return put("GPS_INPUT", kFix,
                   with_validity(fix_of(fields.at<std::int32_t>(12), fields.at<std::int32_t>(16), fields.at<float>(20)),
                                 fields.at<std::uint8_t>(61) >= 2));
      case 11011:
        return add_position_delta(fields);
      default:
        return;
    }
  }

  static NavSample with_validity(NavSample sample, bool is_good) {
    sample.valid = sample.valid && is_good;
    return sample;
  }

  void add_pressure(const char* name, const Fields& fields) {
    has_boot_time(fields.at<std::uint32_t>(0));
    put(name, NavQuantity::kPressure, sample_of({fields.at<float>(4) * 100.0, 0, 0}));
    put(name, NavQuantity::kTemperature, sample_of({fields.at<std::int16_t>(12) * 0.01, 0, 0}));
  }

  void add_quaternion(const Fields& fields) {
    has_boot_time(fields.at<std::uint32_t>(0));
    const Eigen::Vector3d xyz = fields.three<float>(8);
    const Eigen::Quaterniond q(fields.at<float>(4), xyz.x(), xyz.y(), xyz.z());
    if (std::fabs(q.norm() - 1.0) <= 1e-3) {
      const Eigen::Vector3d rpy = rpy_of(q.normalized().toRotationMatrix());
      put("ATTITUDE_QUATERNION", NavQuantity::kAttitude, sample_of(from_ned::attitude(rpy)));
    }
    put("ATTITUDE_QUATERNION", NavQuantity::kTurnRate, sample_of(from_ned::body(fields.three<float>(20))));
  }

  void add_distance(const Fields& fields) {
    has_boot_time(fields.at<std::uint32_t>(0));
    const auto least_cm = fields.at<std::uint16_t>(4), most_cm = fields.at<std::uint16_t>(6);
    const auto now_cm = fields.at<std::uint16_t>(8);
    const NavSample sample = with_validity(sample_of({now_cm * 0.01, 0, 0}), now_cm >= least_cm && now_cm <= most_cm);
    const auto id = fields.at<std::uint8_t>(11);  // of several that one sender reads
    put(id == 0 ? "DISTANCE_SENSOR" : fmt::format("DISTANCE_SENSOR[{}]", id), NavQuantity::kRange, sample);
  }

  /// How far the vehicle moved in the time before: the velocity in the middle of it.
  void add_position_delta(const Fields& fields) {
    const double step_s = static_cast<double>(fields.at<std::uint64_t>(8)) * 1e-6;
    if (!(step_s > 0.0)) return;
    time_s_ -= step_s / 2.0;
    put("VISION_POSITION_DELTA", NavQuantity::kVelocity, sample_of(from_ned::body(fields.three<float>(28)) / step_s));
  }

  DeviceClock& clock_;
  MavlinkNav::Sender sender_;
  double received_s_, time_s_;
  std::string address_;
  std::optional<MavlinkNav::Made> made_;
  std::vector<Report> reports_;
};

}  // namespace

bool MavlinkNav::is_ground_station(const MavlinkFrame& frame) {
  constexpr std::uint8_t kFirst = 250;
  return frame.system >= kFirst;
}

bool MavlinkNav::is_of_vehicle(const MavlinkFrame& frame) {
  return !is_ground_station(frame) && std::ranges::find(kConverted, frame.message) != kConverted.end();
}

std::vector<Report> MavlinkNav::add(const MavlinkFrame& frame, double received_s) {
  return Message(frame, received_s, clocks_[{frame.system, frame.component}]).take();
}

}  // namespace pingvox
