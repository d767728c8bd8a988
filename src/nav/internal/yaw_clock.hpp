#pragma once

#include <optional>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/nav/clock_offset.hpp"

namespace pingvox {

/// As for a trajectory: by how much the times of a yaw are off.
std::optional<ClockOffset> clock_error(const std::vector<YawChange>& changes, const std::vector<TimeSpan>& pauses,
                                       const TimeSeries& yaw_rad);

/// Shorter ones are ordinary.
inline constexpr double kMinPause_s = 2.0;

/// The first pause of the yaw, or of the changes, after which the picture turns as if no time had passed: there a clock
/// jumped ahead.
std::optional<ClockOffset> clock_jump(const std::vector<YawChange>& changes, const std::vector<TimeSpan>& pauses,
                                      const TimeSeries& yaw_rad);

}  // namespace pingvox
