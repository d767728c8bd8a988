#pragma once

// Messages of an autopilot, written by the bits of their checksum, and logs of them.

#include <array>
#include <bit>
#include <cstdint>
#include <string>

namespace pingvox::test {

/// A message of MAVLink 2.
class MavlinkMessage {
 public:
  MavlinkMessage(std::uint8_t message, std::uint8_t extra) : message_(message), extra_(extra) {}

  MavlinkMessage& add(std::uint32_t word, int bytes = 4) {
    for (int i = 0; i < bytes; ++i) payload_ += static_cast<char>(word >> (8 * i));
    return *this;
  }
  MavlinkMessage& add(float number) { return add(std::bit_cast<std::uint32_t>(number)); }

  std::string bytes() const {
    std::string frame = {'\xfd', static_cast<char>(payload_.size()), 0, 0, 0, 1, 1, static_cast<char>(message_), 0, 0};
    frame += payload_;
    unsigned crc = 0xffff;
    for (std::size_t i = 1; i <= frame.size(); ++i) {
      crc ^= i < frame.size() ? static_cast<std::uint8_t>(frame[i]) : extra_;
      for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0x8408U : crc >> 1U;
    }
    return frame + static_cast<char>(crc & 0xffU) + static_cast<char>(crc >> 8U);
  }

 private:
  std::uint8_t message_, extra_;
  std::string payload_;
};

/// A vehicle that heads north.
inline std::string mavlink_attitude(std::uint32_t boot_ms) {
  MavlinkMessage message(30, 39);
  message.add(boot_ms);
  for (int i = 0; i < 6; ++i) message.add(0.0F);
  return message.bytes();
}

inline std::string mavlink_position(std::uint32_t boot_ms, float north_m, float east_m, float down_m) {
  MavlinkMessage message(32, 185);
  message.add(boot_ms).add(north_m).add(east_m).add(down_m);
  for (int i = 0; i < 3; ++i) message.add(0.0F);
  return message.bytes();
}

/// GLOBAL_POSITION_INT at 37.7 degrees north, 122 west.
inline std::string mavlink_global_position(std::uint32_t boot_ms, std::int32_t above_home_mm) {
  MavlinkMessage message(33, 104);
  message.add(boot_ms).add(377'000'000U).add(static_cast<std::uint32_t>(-1'220'000'000)).add(5000U);
  message.add(static_cast<std::uint32_t>(above_home_mm));
  return message.add(0U).add(0U, 2).add(9000U, 2).bytes();
}

/// A record of a .tlog.
inline std::string tlog_record(double time_s, const std::string& message) {
  const auto us = static_cast<std::uint64_t>(1e6 * time_s);
  std::string record;
  for (int shift = 56; shift >= 0; shift -= 8) record += static_cast<char>(us >> shift);
  return record + message;
}

}  // namespace pingvox::test
