#include "peer.hpp"

#include "bench/paired_timing.hpp"

namespace pingvox::bench {

std::vector<PeerScan> peer_scans(std::span<const RayCloud> scans) {
  std::vector<PeerScan> all(scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    all[i].origin_m = {scans[i].origin_m.x(), scans[i].origin_m.y(), scans[i].origin_m.z()};
    all[i].cloud.reserve(scans[i].ends_m.size());
    for (const Eigen::Vector3f& end_m : scans[i].ends_m) all[i].cloud.push_back(end_m.x(), end_m.y(), end_m.z());
  }
  return all;
}

void insert(octomap::OcTree& tree, std::span<const PeerScan> scans, PeerEnds ends, PeerMode mode) {
  const bool lazy = mode == PeerMode::kLazy;
  for (const PeerScan& scan : scans) {
    tree.insertPointCloud(scan.cloud, scan.origin_m, -1.0, lazy, ends == PeerEnds::kCells);
  }
  synchronize(tree, mode);
}

void synchronize(octomap::OcTree& tree, PeerMode mode) {
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
