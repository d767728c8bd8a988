#pragma once

#include <string>
#include <string_view>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/result.hpp"

/// A pose on a vehicle as "x,y,z,roll,pitch,yaw", in metres and degrees.
namespace pingvox {

/// @return kBadOption when it is not six finite numbers
Result<Pose> mount_from(std::string_view text);
std::string mount_text(const Pose& pose);

}  // namespace pingvox
