#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>

#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox::app {

/// Range of the thresholds that echoes were detected with.
struct ThresholdRange {
  std::optional<int> min, max;  ///< nullopt: no echoes

  void add(std::span<const std::optional<Echo>> echoes) {
    for (const auto& echo : echoes) {
      if (!echo) continue;
      min = std::min(min.value_or(echo->threshold), echo->threshold);
      max = std::max(max.value_or(echo->threshold), echo->threshold);
    }
  }

  /// "14..70 (automatic)"
  /// @param given  --threshold, nullopt: automatic
  std::string text(const std::optional<int>& given) const {
    if (given) return std::to_string(*given);
    if (!min) return "automatic";
    const std::string range = *min == *max ? std::to_string(*min) : std::to_string(*min) + ".." + std::to_string(*max);
    return range + " (automatic)";
  }
};

}  // namespace pingvox::app
