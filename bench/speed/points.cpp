#include "points.hpp"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "bench/duel.hpp"
#include "peer.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/sim/random.hpp"
#include "same_map.hpp"

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

void update(OccupancyMap& map, std::span<const Key> keys, LogOdds hit) {
  (void)map.update(keys, hit);
}

void update(octomap::OcTree& tree, std::span<const octomap::OcTreeKey> keys, LogOdds hit, PeerMode mode) {
  const bool lazy = mode == PeerMode::kLazy;
  for (const octomap::OcTreeKey& key : keys) tree.updateNode(key, hit.value(), lazy);
  if (!lazy) return;
  tree.updateInnerOccupancy();
  tree.prune();
}

PeerMode faster_mode(std::span<const octomap::OcTreeKey> keys, LogOdds hit) {
  const auto time_of = [&](PeerMode mode) {
    octomap::OcTree tree(kCell_m);
    const double started = cpu_time_s();
    update(tree, keys, hit, mode);
    return cpu_time_s() - started;
  };
  return time_of(PeerMode::kEager) < time_of(PeerMode::kLazy) ? PeerMode::kEager : PeerMode::kLazy;
}

Result<std::vector<Row>> points(const std::string& name, double sigma) {
  const LogOdds hit = LogOdds::from_probability(0.7);
  const std::vector<Key> keys = normal_keys(sigma);
  std::vector<octomap::OcTreeKey> peer_keys;
  peer_keys.reserve(keys.size());
  for (const Key& key : keys) peer_keys.emplace_back(key.x, key.y, key.z);
  const PeerMode mode = faster_mode(peer_keys, hit);
  std::optional<OccupancyMap> map;
  std::unique_ptr<octomap::OcTree> tree;
  const Side ours{[&] { map.emplace(MapOptions{.resolution_m = kCell_m}); }, [&] { update(*map, keys, hit); }};
  const Side peer{[&] { tree = std::make_unique<octomap::OcTree>(kCell_m); },
                  [&] { update(*tree, peer_keys, hit, mode); }};
  ours.prepare();
  ours.work();
  peer.prepare();
  peer.work();
  if (const auto same = same_to_the_bit(*map, *tree); !same) return tl::unexpected(same.error());
  map.reset();
  tree.reset();
  const auto memory = [](const Side& side) {
    return peak_memory_bytes([&] {
      side.prepare();
      side.work();
    });
  };
  const DuelMemory bytes{memory(ours), memory(peer)};
  Row row = speed_row(name, duel(ours, peer), bytes);
  row.add("octomap_mode", mode == PeerMode::kEager ? "eager" : "lazy");
  return std::vector{row};
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
