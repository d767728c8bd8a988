#pragma once

#include "pingvox/recording/campaign.hpp"
#include "pingvox/recording/recording.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The recording of a dive. @return as Recording::open
Result<Recording> open_dive(const Dive& dive, const RecordingOptions& options);

}  // namespace pingvox
