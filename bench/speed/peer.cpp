#include "peer.hpp"

#include "bench/paired_timing.hpp"

namespace pingvox::bench {

std::vector<octomap::Pointcloud> clouds_of(std::span<const RayCloud> scans) {
  std::vector<octomap::Pointcloud> clouds(scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    clouds[i].reserve(scans[i].size());
    for (const Eigen::Vector3f& end_m : scans[i]) clouds[i].push_back(end_m.x(), end_m.y(), end_m.z());
  }
  return clouds;
}

void insert(octomap::OcTree& tree, std::span<const octomap::Pointcloud> clouds, PeerEnds ends, PeerMode mode) {
  const bool lazy = mode == PeerMode::kLazy;
  for (const octomap::Pointcloud& cloud : clouds) {
    tree.insertPointCloud(cloud, octomap::point3d(0.0F, 0.0F, 0.0F), -1.0, lazy, ends == PeerEnds::kCells);
  }
  settle(tree, mode);
}

void settle(octomap::OcTree& tree, PeerMode mode) {
  if (mode == PeerMode::kEager) return;
  tree.updateInnerOccupancy();
  tree.prune();
}

PeerMode faster_mode(double resolution_m, const std::function<void(octomap::OcTree&, PeerMode)>& fill) {
  const auto time_of = [&](PeerMode mode) {
    octomap::OcTree tree(resolution_m);
    const double started = cpu_time_s();
    fill(tree, mode);
    return cpu_time_s() - started;
  };
  return time_of(PeerMode::kEager) < time_of(PeerMode::kLazy) ? PeerMode::kEager : PeerMode::kLazy;
}

}  // namespace pingvox::bench
