#pragma once

#include <octomap/OcTree.h>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::bench {

/// The paper's cube: 100^3 cells around the origin (5,201 inner nodes only if it is centred there).
struct PaperCube {
  static constexpr int kHalf = 50;  ///< cells from the centre to a face
  static constexpr double kCell_m = 0.1;
  LogOdds evidence = LogOdds::from_probability(0.7);
  /// Updates of each cell along each axis. 2 in the authors' program, which sets points 5 cm apart in cells of 10 cm.
  int updates_along_axis = 1;

  void fill(OccupancyMap& map, Pruning pruning) const;
  void fill(octomap::OcTree& tree, Pruning pruning) const;
};

}  // namespace pingvox::bench
