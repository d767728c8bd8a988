#include "points.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "map_benchmark.hpp"
#include "peer.hpp"
#include "pingvox/geometry/random.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05, kMean = 10'000.0;
constexpr std::size_t kPoints = 1'000'000;

std::vector<Key> normal_keys(double sigma) {
  Random random(8);
  const auto word = [&] {
    return static_cast<std::uint16_t>(std::clamp(std::round(kMean + sigma * random.normal()), 0.0, 65535.0));
  };
  std::vector<Key> keys(kPoints);
  for (Key& key : keys) {
    key.x = word();
    key.y = word();
    key.z = word();
  }
  return keys;
}

void update(octomap::OcTree& tree, std::span<const octomap::OcTreeKey> keys, LogOdds hit, PeerMode mode) {
  for (const octomap::OcTreeKey& key : keys) tree.updateNode(key, hit.value(), mode == PeerMode::kLazy);
  synchronize(tree, mode);
}

Result<std::vector<Row>> points(const std::string& name, double sigma) {
  const LogOdds hit = LogOdds::from_probability(0.7);
  const std::vector<Key> keys = normal_keys(sigma);
  std::vector<octomap::OcTreeKey> peer_keys;
  peer_keys.reserve(keys.size());
  for (const Key& key : keys) peer_keys.emplace_back(key.x, key.y, key.z);
  const auto fill_peer = [&](octomap::OcTree& tree, PeerMode mode) { update(tree, peer_keys, hit, mode); };
  const PeerMode mode = faster_mode(kCell_m, fill_peer);
  Result<Row> row =
      measure({.name = name,
               .resolution_m = kCell_m,
               .ours = [&](OccupancyMap& map, ScanUpdate&) { (void)map.update(std::span<const Key>(keys), hit); },
               .peer = [&](octomap::OcTree& tree) { fill_peer(tree, mode); }});
  if (!row) return tl::unexpected(row.error());
  row->add("octomap_mode", mode == PeerMode::kEager ? "eager" : "lazy");
  return std::vector{*row};
}

}  // namespace

Result<std::vector<Row>> points_5000(const BenchOptions&) {
  return points("points-5000", 5000.0);
}

Result<std::vector<Row>> points_50(const BenchOptions&) {
  return points("points-50", 50.0);
}

Result<std::vector<Row>> points_5(const BenchOptions&) {
  return points("points-5", 5.0);
}

}  // namespace pingvox::bench
