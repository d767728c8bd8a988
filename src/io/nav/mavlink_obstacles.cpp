#include "io/internal/mavlink_obstacles.hpp"

#include <bit>
#include <concepts>

namespace pingvox {
namespace {

template <std::unsigned_integral T>
void put(std::vector<std::uint8_t>& payload, T value) {
  for (unsigned shift = 0; shift < 8 * sizeof(T); shift += 8) {
    payload.push_back(static_cast<std::uint8_t>((value >> shift) & 0xffU));
  }
}

}  // namespace

std::vector<std::uint8_t> payload_of(const ObstacleDistance& obstacles) {
  constexpr std::uint8_t kUnknownSensor = 4, kWholeDegrees = 5, kBodyFrd = 12;
  constexpr float kDegrees = 5.0F, kAhead_deg = 0.0F;
  std::vector<std::uint8_t> payload;
  put(payload, obstacles.time_us);
  for (const std::uint16_t cm : obstacles.cm) put(payload, cm);
  put(payload, obstacles.min_cm);
  put(payload, obstacles.max_cm);
  payload.push_back(kUnknownSensor);
  payload.push_back(kWholeDegrees);
  put(payload, std::bit_cast<std::uint32_t>(kDegrees));
  put(payload, std::bit_cast<std::uint32_t>(kAhead_deg));
  payload.push_back(kBodyFrd);
  return payload;
}

}  // namespace pingvox
