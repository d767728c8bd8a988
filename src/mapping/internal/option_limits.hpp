#pragma once

#include <numbers>

#include "pingvox/limits.hpp"

/// What fields of options of mapping may be: for their validate() and for the command line.
namespace pingvox {

inline constexpr Limits kBeamWidths_rad{0.0, std::numbers::pi, Limits::Ends::kLowOut};
inline constexpr Limits kBeamHeights_rad{0.0, std::numbers::pi, Limits::Ends::kBothOut};
inline constexpr Limits kFreeShares{0.0, 1.0, Limits::Ends::kLowOut};
inline constexpr Limits kHits{0.5, 1.0, Limits::Ends::kBothOut};    ///< probabilities
inline constexpr Limits kMisses{0.0, 0.5, Limits::Ends::kBothOut};  ///< probabilities
inline constexpr Limits kSoundSpeedRatios{0.1, 10.0, Limits::Ends::kBothOut};

}  // namespace pingvox
