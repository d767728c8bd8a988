#pragma once

#include "pingvox/recording/map_origin.hpp"
#include "pingvox/recording/vehicle_path.hpp"

namespace pingvox {

/// A path in the frame of another origin.
/// @param from  its own
VehiclePath moved_to_origin(VehiclePath path, const MapOrigin& from, const MapOrigin& to);

}  // namespace pingvox
