#pragma once

#include <limits>
#include <numbers>
#include <span>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/limits.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Field of view of a scanning sonar, which makes full turns about its z axis.
struct ViewOptions {
  static constexpr Limits kMinRanges_m{0.0, std::numeric_limits<double>::infinity(), Limits::Ends::kHighOut};
  static constexpr Limits kHeights_rad{0.0, std::numbers::pi, Limits::Ends::kLowOut};
  double min_range_m = 0.0;
  double max_range_m = std::numeric_limits<double>::infinity();
  double height_rad = 35.0 * kDegree_rad;  ///< vertical beam width, full angle

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The occupied cells of `surface` that a sonar could see from any of some poses: the middle of one of a cell's faces
/// is in range, within the vertical beam width, and in line of sight through cells that `world` does not call occupied.
/// Poses less than a cell apart count once, and of more than 1000 such an even choice.
/// @param surface          the cells in question: `world` itself, or one layer of it
/// @param map_from_sensor  poses of the head
/// @return kBadOption when the options do not validate or the lattices differ; kLimit when more than 20 million cells
///         are occupied
Result<OccupancyMap> visible_cells(const OccupancyMap& surface, const OccupancyMap& world,
                                   std::span<const Pose> map_from_sensor, const ViewOptions& options);

}  // namespace pingvox
