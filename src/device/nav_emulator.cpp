#include "device/internal/nav_emulator.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cassert>
#include <numbers>
#include <string_view>
#include <utility>

#include "base/option_errors.hpp"
#include "io/internal/mavlink.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {
namespace {

using Message = NavEmulator::Message;

/// Roll, pitch and yaw of a forward-right-down body in north-east-down [rad].
Eigen::Vector3d roll_pitch_yaw(const Pose& pose) {
  // The conversion is its own inverse.
  return from_ned::attitude(rpy_of(pose.linear()));
}

Eigen::Vector3d north_east_down(const Eigen::Vector3d& position_m) {
  return from_ned::world(position_m);
}

/// Autopilots without a position report 0, 0, and readers take that as none: at the origin it is off by 1 mm, as no
/// estimate is exact.
Eigen::Vector3d estimated_position(const Pose& pose) {
  constexpr double kError_m = 0.001;
  Eigen::Vector3d position_m = north_east_down(pose.translation());
  if (position_m.head<2>().isZero(0.0)) position_m.x() = kError_m;
  return position_m;
}

/// In the map frame [m/s].
Eigen::Vector3d velocity(const NavEmulator::PoseAt& pose_at, double time_s) {
  constexpr double kStep_s = 0.05;
  return (pose_at(time_s).translation() - pose_at(time_s - kStep_s).translation()) / kStep_s;
}

/// Fields of a MAVLink message, little-endian.
class Payload {
 public:
  Payload& add(std::uint32_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8)
      bytes_.push_back(static_cast<std::uint8_t>((word >> shift) & 0xffU));
    return *this;
  }
  Payload& add(double number) { return add(std::bit_cast<std::uint32_t>(static_cast<float>(number))); }
  Payload& add(const Eigen::Vector3d& three) { return add(three.x()).add(three.y()).add(three.z()); }
  Payload& add_bytes(std::initializer_list<std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) bytes_.push_back(byte);
    return *this;
  }
  const Message& bytes() const { return bytes_; }

 private:
  Message bytes_;
};

Message bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

}  // namespace

OptionErrors NavEmulatorOptions::errors() const {
  OptionErrors errors;
  errors.require("reports_per_s", reports_per_s, {0.1, 1000.0});
  errors.require("lost", lost, {0.0, 0.5});
  errors.require("doubled", doubled, {0.0, 0.5});
  errors.require("damaged", damaged, {0.0, 0.5});
  return errors;
}

Result<void> NavEmulatorOptions::validate() const {
  return errors().result("emulator of navigation");
}

NavEmulator::Say NavEmulator::mavlink(PoseAt pose_at) {
  return [pose_at = std::move(pose_at), sequence = std::uint8_t{0}](double now_s) mutable {
    constexpr std::uint32_t kHeartbeat = 0, kAttitude = 30, kLocalPosition = 32, kPressure2 = 137;
    constexpr double kSurface_hpa = 1013.25, kHpaPerMetre = 1025.0 * 9.80665 / 100.0;
    const Pose pose = pose_at(now_s);
    const auto boot_ms = static_cast<std::uint32_t>(std::lround(now_s * 1000.0));
    std::vector<Message> messages;
    const auto say = [&](std::uint32_t message, const Payload& payload) {
      messages.push_back(make_mavlink_frame(message, payload.bytes(), {.sequence = sequence++}));
    };
    // A submarine of ArduPilot, armed; protocol 3.
    say(kHeartbeat, Payload().add(std::uint32_t{0}).add_bytes({12, 3, 0x81, 4, 3}));
    say(kAttitude, Payload().add(boot_ms).add(roll_pitch_yaw(pose)).add(Eigen::Vector3d(0, 0, 0)));
    say(kLocalPosition,
        Payload().add(boot_ms).add(estimated_position(pose)).add(north_east_down(velocity(pose_at, now_s))));
    const double depth_m = std::max(0.0, -pose.translation().z());
    say(kPressure2,
        Payload().add(boot_ms).add(kSurface_hpa + depth_m * kHpaPerMetre).add(0.0).add_bytes({0xdc, 0x05, 0, 0}));
    return messages;
  };
}

NavEmulator::Say NavEmulator::a50(PoseAt pose_at, HasBottom has_bottom) {
  return [pose_at = std::move(pose_at), has_bottom = std::move(has_bottom), last_s = std::optional<double>(),
          known_m = std::optional<Eigen::Vector3d>()](double now_s) mutable {
    // The clock of a device that nobody set.
    constexpr double kClock_s = 1'546'300'800.0, kLate_s = 0.1, kDegPerRad = 180.0 / std::numbers::pi;
    const Pose pose = pose_at(now_s);
    const double made_s = std::max(now_s - kLate_s, 0.0);
    const bool is_valid = !has_bottom || has_bottom(now_s);
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    if (is_valid) v = from_ned::body(pose_at(made_s).linear().transpose() * velocity(pose_at, made_s));
    if (is_valid || !known_m) known_m = pose.translation();
    const double step_ms = (now_s - std::exchange(last_s, now_s).value_or(now_s)) * 1000.0;
    const Eigen::Vector3d p = north_east_down(*known_m), rpy_deg = roll_pitch_yaw(pose) * kDegPerRad;
    const auto us = [](double seconds) { return std::llround((kClock_s + seconds) * 1e6); };
    return std::vector<Message>{
        bytes_of(fmt::format(R"({{"time":{:.2f},"vx":{:.6f},"vy":{:.6f},"vz":{:.6f},"fom":0.002,"altitude":-1,)"
                             R"("velocity_valid":{},"status":0,"time_of_validity":{},"time_of_transmission":{},)"
                             R"("format":"json_v3.1","type":"velocity"}})"
                             "\r\n",
                             step_ms, v.x(), v.y(), v.z(), is_valid, us(made_s), us(now_s))),
        bytes_of(fmt::format(R"({{"ts":{:.3f},"x":{:.6f},"y":{:.6f},"z":{:.6f},"std":0.01,"roll":{:.6f},)"
                             R"("pitch":{:.6f},"yaw":{:.6f},"status":0,"format":"json_v3.1","type":"position_local"}})"
                             "\r\n",
                             now_s, p.x(), p.y(), p.z(), rpy_deg.x(), rpy_deg.y(), rpy_deg.z()))};
  };
}

NavEmulator::NavEmulator(const NavEmulatorOptions& options, Say say)
    : options_(options), say_(std::move(say)), random_(options.seed) {
  assert(options.validate());
}

std::vector<Message> NavEmulator::send(double now_s) {
  std::vector<Message> sent;
  if (now_s < due_s_) return sent;
  // Reports that are overdue are not made up for.
  due_s_ = std::max(due_s_ + 1.0 / options_.reports_per_s, now_s);
  for (Message& message : say_(now_s)) {
    if (random_.uniform() < options_.lost) continue;
    if (random_.uniform() < options_.damaged) {
      message[random_.bits() % message.size()] ^= static_cast<std::uint8_t>(1U << (random_.bits() % 8));
    }
    if (random_.uniform() < options_.doubled) sent.push_back(message);
    sent.push_back(std::move(message));
  }
  return sent;
}

}  // namespace pingvox
