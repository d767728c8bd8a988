#pragma once

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Finds times that cannot be in seconds: thousands of years after 1970, samples of heading or velocity that are too
/// rare to be of a sensor, or too many samples in a second. Sets `fault`; where they are only rare, `doubt`.
/// @param source  in order of time
void check_times(NavSource& source);

}  // namespace pingvox
