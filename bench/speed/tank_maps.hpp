#pragma once

#include <octomap/OcTree.h>

#include <memory>
#include <string>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox::bench {

/// Identical maps in both libraries: 3 sweeps of bundles in cells of 5 cm, as in tank-3d. Both get the cells that
/// liboctomap finds for each sweep, one update a cell.
struct TankMaps {
  std::string input;  ///< as in TankBeams
  OccupancyMap ours;
  std::unique_ptr<octomap::OcTree> peer;
};
Result<TankMaps> tank_maps();

}  // namespace pingvox::bench
