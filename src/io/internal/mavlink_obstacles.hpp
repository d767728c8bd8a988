#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pingvox {

/// MAVLink's OBSTACLE_DISTANCE: the nearest obstacles around a vehicle, in sectors of 5 degrees clockwise from ahead,
/// in its body frame (forward, right, down).
struct ObstacleDistance {
  static constexpr std::uint16_t kUnknown = 65'535;
  std::uint64_t time_us = 0;                  ///< since 1970
  std::array<std::uint16_t, 72> cm = {};      ///< max_cm + 1: nothing; kUnknown
  std::uint16_t min_cm = 0, max_cm = 65'533;  ///< that can be reported
};
/// Its payload, for make_mavlink_frame with `kObstacleDistance`.
std::vector<std::uint8_t> payload_of(const ObstacleDistance& obstacles);
inline constexpr std::uint32_t kObstacleDistance = 330;

}  // namespace pingvox
