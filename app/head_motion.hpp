#pragma once

#include <array>
#include <optional>

#include "pingvox/device/head_settings.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// Angle of the smallest step of a Ping360.
inline constexpr double kGradian_deg = 0.9;

/// The motion of a head, as typed.
struct HeadMotion {
  double step_deg = kGradian_deg;
  std::optional<std::array<double, 2>> sector_deg;  ///< counter-clockwise from the first to the last
};

/// Whether two bearings bound a sector: the smaller one first, less than a turn apart.
bool is_sector(const std::array<double, 2>& bearings_deg);

/// @return kBadOption for a step that the head does not have, or one beyond the sector
Result<void> apply(const HeadMotion& motion, Ping360Settings& head);
Result<void> apply(const HeadMotion& motion, MicronSettings& head);

}  // namespace pingvox::app
