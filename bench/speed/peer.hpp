#pragma once

#include <octomap/OcTree.h>

#include <functional>
#include <span>
#include <vector>

#include "tank_echoes.hpp"

namespace pingvox::bench {

/// How liboctomap is called.
enum class PeerMode {
  kEager,  ///< parents updated and pruned after each update
  kLazy,   ///< parents updated and pruned once, after all scans
};
enum class PeerEnds {
  kExact,  ///< a ray to each point
  kCells,  ///< a ray to the middle of each cell with a point: `discretize`
};

/// A scan in the form of liboctomap.
struct PeerScan {
  octomap::point3d origin_m;
  octomap::Pointcloud cloud;
};
std::vector<PeerScan> peer_scans(std::span<const RayCloud> scans);

void insert(octomap::OcTree& tree, std::span<const PeerScan> scans, PeerEnds ends, PeerMode mode);

/// Updates parents and prunes after lazy updates.
void synchronize(octomap::OcTree& tree, PeerMode mode);

/// The mode in which an empty map is filled faster, by one run of each.
PeerMode faster_mode(double resolution_m, const std::function<void(octomap::OcTree&, PeerMode)>& fill);

}  // namespace pingvox::bench
