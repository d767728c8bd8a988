#pragma once

#include <octomap/OcTree.h>

#include <memory>
#include <string>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox::bench {

/// The same map twice, to the bit: 3 sweeps of bundles in cells of 5 cm, what tank-3d makes. Both were given the cells
/// that liboctomap finds for each sweep, one update a cell, and grew as maps grow.
struct TankMaps {
  std::string input;  ///< as in TankBeams
  OccupancyMap ours;
  std::unique_ptr<octomap::OcTree> peer;
};
Result<TankMaps> tank_maps();

}  // namespace pingvox::bench
