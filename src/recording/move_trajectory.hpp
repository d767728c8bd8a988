#pragma once

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"

namespace pingvox {

/// The same trajectory in another frame. @param to_from_map  from its frame to the other one
Trajectory moved(const Trajectory& trajectory, const Pose& to_from_map);

}  // namespace pingvox
