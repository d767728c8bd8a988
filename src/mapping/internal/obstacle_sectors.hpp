#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

struct ObstacleOptions {
  double min_range_m = 0.2;    ///< nearer cells are the vehicle itself; >= 0
  double max_range_m = 10.0;   ///< > min_range_m, at most 650
  double half_height_m = 0.5;  ///< cells up to so far above and below the vehicle count; > 0, at most 100

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Nearest obstacles around a vehicle in the horizontal plane, in sectors of 5 degrees: the first one is centred ahead,
/// the others follow clockwise seen from above.
struct ObstacleSectors {
  static constexpr std::size_t kSectors = 72;
  enum class What {
    kUnknown,  ///< nothing occupied is known, nor that all is free from the first metre to max_range_m along the middle
    kClear,    ///< nothing within max_range_m
    kObstacle,
  };
  struct Sector {
    What what = What::kUnknown;
    double range_m = 0.0;  ///< kObstacle: of the nearest cell's centre, from the vehicle
  };
  std::array<Sector, kSectors> sectors;
};

/// Cells that are occupied by the map's thresholds count in each sector that they reach into. Roll and pitch of the
/// vehicle turn nothing. REQUIRES valid options.
ObstacleSectors nearest_obstacles(const OccupancyMap& map, const Pose& map_from_body, const ObstacleOptions& options);

}  // namespace pingvox
