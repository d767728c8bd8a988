#pragma once

#include <octomap/OcTree.h>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::bench {

/// The paper's cube: 100^3 cells around the origin (5,201 inner nodes only if it is centred there).
struct PaperCube {
  static constexpr int kHalf = 50;  ///< cells from the middle to a face
  static constexpr double kCell_m = 0.1;
  LogOdds evidence = LogOdds::from_probability(0.7);
  /// Along each axis a cell gets this many updates in a row: the authors' program sets points 5 cm apart in cells of
  /// 10 cm, which is 2.
  int updates_along_axis = 1;

  void fill(OccupancyMap& map, Pruning pruning) const;
  void fill(octomap::OcTree& tree, Pruning pruning) const;
};

}  // namespace pingvox::bench
