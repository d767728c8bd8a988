#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Fields of Ping messages, little-endian.
namespace pingvox {

/// Numbers of who sends and who shall take a message.
inline constexpr std::uint8_t kPingHost = 0, kPingHead = 2;
inline constexpr int kTurn_grad = 400;

inline void put_u16(std::vector<std::uint8_t>& payload, std::uint16_t value) {
  payload.push_back(static_cast<std::uint8_t>(value & 0xffU));
  payload.push_back(static_cast<std::uint8_t>(value >> 8U));
}

/// REQUIRES at least place + 2 bytes.
inline std::uint16_t get_u16(std::span<const std::uint8_t> payload, std::size_t place) {
  return static_cast<std::uint16_t>(payload[place] | (payload[place + 1] << 8));
}

}  // namespace pingvox
