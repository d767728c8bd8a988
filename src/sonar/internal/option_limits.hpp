#pragma once

#include <limits>

#include "pingvox/limits.hpp"
#include "pingvox/sonar/background.hpp"

/// What fields of options of detecting echoes may be: for their validate() and for the command line.
namespace pingvox {

inline constexpr Limits kFilterKernels{1.0, 99.0};  ///< odd ones
inline constexpr Limits kFilterSigmas{0.0, 1000.0, Limits::Ends::kLowOut};
inline constexpr Limits kNearestRanges_m{0.0, std::numeric_limits<double>::infinity(), Limits::Ends::kHighOut};
inline constexpr Limits kFarthestRanges_m{0.0, std::numeric_limits<double>::infinity(), Limits::Ends::kLowOut};
inline constexpr Limits kBackgroundRanges_m{0.0, BackgroundOptions::kMaxRange_m, Limits::Ends::kLowOut};

}  // namespace pingvox
