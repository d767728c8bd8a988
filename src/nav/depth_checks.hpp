#pragma once

#include <span>
#include <string>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// What is wrong with the unit or the sense of a depth by its own numbers: it changes faster than a vehicle dives, or
/// is above the surface all the time. Empty: nothing.
/// @param source  in order of time
std::string fault_of_depth(const NavSource& source);

/// Compares the depths of a log with the depth by its pressure: the `fault` of one says that it is in another unit. And
/// the heights of its positions with both: the `doubt` of one says that it points down where up is meant.
/// @param sources  each in order of time, pressures in Pa
void compare_depths(std::span<NavSource> sources);

}  // namespace pingvox
