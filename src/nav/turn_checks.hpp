#pragma once

#include <span>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Compares how the vehicle turns by the turn rates, the attitudes and headings, and the positions of a log. Where one
/// turns as the other but 57.3 times as far, it is in degrees, and its `fault` says so. Where a heading turns against
/// the turn rate, another heading or the path, or stands still while the path turns, its `doubt` says so.
/// @param sources  each in order of time
void compare_turns(std::span<NavSource> sources);

}  // namespace pingvox
