#pragma once

#include <optional>
#include <vector>

#include "pingvox/slam/clock_offset.hpp"
#include "slam/navigation.hpp"

namespace pingvox {

/// As for a trajectory: by how much the times of a yaw are off.
std::optional<ClockOffset> clock_error(const std::vector<YawChange>& changes, const TimeSeries& yaw_rad);

}  // namespace pingvox
