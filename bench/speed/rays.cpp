#include "rays.hpp"

#include <fmt/core.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cstdint>

#include "bench/paired_timing.hpp"
#include "geometry/internal/ray_dda.hpp"
#include "pingvox/geometry/random.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05, kHalfBox_m = 10.0;
constexpr std::size_t kRays = 131'072;
/// Maximum fraction of rays that may pass an edge differently, since liboctomap sums floats.
constexpr double kMaxOther = 0.01;

/// Two ends of a ray [m].
struct Segment {
  Eigen::Vector3d from_m, to_m;
};

std::vector<Segment> random_segments() {
  Random random(11);
  const auto coordinate = [&] {
    return static_cast<double>(static_cast<float>((2.0 * random.uniform() - 1.0) * kHalfBox_m));
  };
  std::vector<Segment> segments(kRays);
  for (auto& [from_m, to_m] : segments) {
    for (double& c : from_m) c = coordinate();
    for (double& c : to_m) c = coordinate();
  }
  return segments;
}

/// Calls f(ray's number, its keys) for each ray.
template <class F>
void for_each_ray(const Lattice& lattice, std::span<const Segment> segments, std::vector<Key>& keys, F&& f) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    keys.clear();
    const auto ray = dda<std::uint16_t>(lattice, segments[i].from_m, segments[i].to_m);
    // Number by number: the parts of a whole key are stored, and waited for to be copied at once.
    for (const Key key : *ray) keys.emplace_back(key.x, key.y, key.z);
    f(i, std::span<const Key>(keys));
  }
}

octomap::point3d as_peer(const Eigen::Vector3d& point_m) {
  return {static_cast<float>(point_m.x()), static_cast<float>(point_m.y()), static_cast<float>(point_m.z())};
}

bool are_same(std::span<const Key> ours, const octomap::KeyRay& peer) {
  return std::equal(ours.begin(), ours.end(), peer.begin(), peer.end(), [](const Key& a, const octomap::OcTreeKey& b) {
    return a.x == b[0] && a.y == b[1] && a.z == b[2];
  });
}

}  // namespace

Result<std::vector<Row>> rays(const BenchOptions&) {
  const Lattice lattice(kCell_m);
  const octomap::OcTree tree(kCell_m);
  const std::vector<Segment> segments = random_segments();
  std::vector<std::pair<octomap::point3d, octomap::point3d>> peer_segments;
  peer_segments.reserve(segments.size());
  for (const Segment& s : segments) peer_segments.emplace_back(as_peer(s.from_m), as_peer(s.to_m));
  std::vector<Key> keys;
  octomap::KeyRay peer_keys;

  std::size_t same = 0, cells = 0;
  for_each_ray(lattice, segments, keys, [&](std::size_t i, std::span<const Key> ray) {
    tree.computeRayKeys(peer_segments[i].first, peer_segments[i].second, peer_keys);
    same += are_same(ray, peer_keys);
    cells += ray.size();
  });
  const double share = static_cast<double>(same) / static_cast<double>(segments.size());
  if (share < 1.0 - kMaxOther) {
    return fail(Error::Code::kCorrupt, fmt::format("only {} of {} rays have liboctomap's keys", same, segments.size()));
  }

  // The sums keep the compiler from removing the work.
  std::size_t ours_cells = 0, peer_cells = 0;
  const Side ours{{}, [&] {
                    for_each_ray(lattice, segments, keys,
                                 [&](std::size_t, std::span<const Key> ray) { ours_cells += ray.size(); });
                  }};
  const Side peer{{}, [&] {
                    for (const auto& [from, to] : peer_segments) {
                      tree.computeRayKeys(from, to, peer_keys);
                      peer_cells += peer_keys.size();
                    }
                  }};
  const PairedTimes result = time_in_pairs(ours, peer);
  if (ours_cells % cells != 0 || peer_cells == 0) return fail(Error::Code::kCorrupt, "rays changed while timed");
  Row row = speed_row("rays", result, {});
  row.add("rays", std::uint64_t{segments.size()}).add("cells", std::uint64_t{cells}).add("share_same", share);
  return std::vector{row};
}

}  // namespace pingvox::bench
