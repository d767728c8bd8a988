#pragma once

#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/slam/clock_offset.hpp"
#include "slam/navigation.hpp"

namespace pingvox {

/// As for a trajectory: by how much the times of a yaw are off.
Result<ClockOffset> clock_error(const std::vector<YawChange>& changes, const TimeSeries& yaw_rad);

}  // namespace pingvox
