#pragma once

#include <string_view>

#include "pingvox/nav/nav_log.hpp"

// The subject of a source by its name: "/desired_depth", "/ship/fix".
namespace pingvox {

/// Why a source is not the vehicle's by its name, or by that of the frame whose pose it is (`child`): it is a goal,
/// command or plan, something else (a ship, a buoy, the wind, the depth of the water), the inside of a hull (pressure),
/// or the attitude of a sensor that points elsewhere. Of poses that do not say of what they are, markers as well.
/// Upper case, camelCase and trailing digits do not matter. Empty: it may be the vehicle's.
/// @param is_alone  no position has the same name: with one, a camera's is odometry
std::string_view other_by_name(const NavSource& source, bool is_alone);

}  // namespace pingvox
