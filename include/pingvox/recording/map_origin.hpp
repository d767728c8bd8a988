#pragma once

#include <Eigen/Core>
#include <optional>

#include "pingvox/nav/nav_log.hpp"
#include "pingvox/recording/vehicle_path.hpp"

namespace pingvox {

/// Where 0, 0 of a map is on the earth.
struct MapOrigin {
  /// Of its heights: above the altitude of the fix, or as depths and local positions have them.
  enum class Heights { kAboveFix, kOwn };
  Eigen::Vector3d fix = Eigen::Vector3d::Zero();  ///< as NavQuantity::kFix has it
  Heights heights = Heights::kOwn;
};

/// The origin of the frame of a path: by its fixes, else, of positions in metres east and north, by the median of their
/// distance to the fixes of the same navigation. nullopt: there are none at its time.
/// @param offset_s  that was added to the times of the navigation
std::optional<MapOrigin> map_origin(const VehiclePath& path, const NavLog& nav, double offset_s);

}  // namespace pingvox
