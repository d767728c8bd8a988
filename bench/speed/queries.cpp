#include "queries.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "bench/paired_timing.hpp"
#include "pingvox/geometry/random.hpp"
#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "tank_maps.hpp"

namespace pingvox::bench {
namespace {

constexpr std::size_t kKeys = 1'000'000, kRays = 100'000;
constexpr double kRange_m = 10.0;  ///< the tank is 5 m wide
/// Maximum fraction of rays that may end elsewhere, since liboctomap sums floats.
constexpr double kMaxOther = 0.01;

std::uint64_t below(Random& random, std::uint64_t end) {
  return random.bits() % end;
}

/// A random cell of a random leaf.
Key known_key(const std::vector<Leaf>& leaves, int levels, Random& random) {
  const Leaf& leaf = leaves[below(random, leaves.size())];
  const std::uint64_t edge = std::uint64_t{1} << (levels - leaf.depth);
  const auto word = [&](WideWord lowest) { return static_cast<std::uint16_t>(lowest + below(random, edge)); };
  return {word(leaf.key.x), word(leaf.key.y), word(leaf.key.z)};
}

std::vector<Leaf> leaves_of(const OccupancyMap& map) {
  std::vector<Leaf> all;
  for_each_leaf(map, [&](const Leaf& leaf) { all.push_back(leaf); });
  return all;
}

/// Alternately a known cell and any cell within the map's bounds.
std::vector<Key> random_keys(const OccupancyMap& map) {
  Random random(12);
  const std::vector<Leaf> known = leaves_of(map);
  const Box box = *map.bounds();
  std::vector<Key> keys;
  keys.reserve(kKeys);
  while (keys.size() < kKeys) {
    keys.push_back(known_key(known, map.lattice().depth(), random));
    const Eigen::Array3d share(random.uniform(), random.uniform(), random.uniform());
    if (const auto key = map.lattice().key_of((box.min.array() + share * (box.max - box.min).array()).matrix())) {
      keys.push_back(*key);
    }
  }
  keys.resize(kKeys);
  return keys;
}

Occupancy classify(const octomap::OcTree& tree, const octomap::OcTreeKey& key) {
  const octomap::OcTreeNode* node = tree.search(key);
  if (node == nullptr) return Occupancy::kUnknown;
  return tree.isNodeOccupied(node) ? Occupancy::kOccupied : Occupancy::kFree;
}

struct Cast {
  Eigen::Vector3d origin_m, direction;  ///< exact in single precision
};

std::vector<Cast> random_casts(const OccupancyMap& map) {
  Random random(13);
  const std::vector<Leaf> known = leaves_of(map);
  std::vector<Cast> casts;
  casts.reserve(kRays);
  while (casts.size() < kRays) {
    const Key key = known_key(known, map.lattice().depth(), random);
    const Eigen::Vector3d way(random.normal(), random.normal(), random.normal());
    if (map.classify(key) != Occupancy::kFree || way.norm() < 1e-3) continue;
    casts.push_back(
        {map.lattice().centre_of(key).cast<float>().cast<double>(), way.normalized().cast<float>().cast<double>()});
  }
  return casts;
}

octomap::point3d as_peer(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Whether both ended in the same occupied cell, or neither in one.
bool end_alike(const octomap::OcTree& tree, const RayEnd& ours, bool peer_hit, const octomap::point3d& peer_end) {
  if ((ours.what == Occupancy::kOccupied) != peer_hit) return false;
  if (!peer_hit) return true;
  const octomap::OcTreeKey key = tree.coordToKey(peer_end);
  return ours.key == WideKey{key[0], key[1], key[2]};
}

struct LeafSums {
  std::uint64_t leaves = 0;
  double values = 0.0, sizes_m = 0.0;
  friend bool operator==(const LeafSums&, const LeafSums&) = default;
};

}  // namespace

Result<std::vector<Row>> look_up(const BenchOptions&) {
  const Result<TankMaps> maps = tank_maps();
  if (!maps) return tl::unexpected(maps.error());
  const OccupancyMap& map = maps->ours;
  const octomap::OcTree& tree = *maps->peer;
  const std::vector<Key> keys = random_keys(map);
  std::vector<octomap::OcTreeKey> peer_keys;
  peer_keys.reserve(keys.size());
  for (const Key& key : keys) peer_keys.emplace_back(key.x, key.y, key.z);
  using Counts = std::array<std::uint64_t, 3>;
  Counts counts{};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Occupancy what = map.classify(keys[i]);
    if (what != classify(tree, peer_keys[i])) {
      return fail(Error::Code::kCorrupt, fmt::format("key {} of {} is not what liboctomap says", i, keys.size()));
    }
    ++counts[static_cast<std::size_t>(what)];
  }
  Counts ours_counts{}, peer_counts{};
  const Side ours{[&] { ours_counts = {}; },
                  [&] {
                    for (const Key& key : keys) ++ours_counts[static_cast<std::size_t>(map.classify(key))];
                  }};
  const Side peer{[&] { peer_counts = {}; },
                  [&] {
                    for (const octomap::OcTreeKey& key : peer_keys) {
                      ++peer_counts[static_cast<std::size_t>(classify(tree, key))];
                    }
                  }};
  const PairedTimes result = time_in_pairs(ours, peer);
  if (ours_counts != counts || peer_counts != counts) return fail(Error::Code::kCorrupt, "answers changed while timed");
  Row row = speed_row("look-up", result, {});
  row.add("input", maps->input).add("keys", std::uint64_t{kKeys}).add("unknown", counts[0]);
  return std::vector{row};
}

Result<std::vector<Row>> cast_rays(const BenchOptions&) {
  const Result<TankMaps> maps = tank_maps();
  if (!maps) return tl::unexpected(maps.error());
  const OccupancyMap& map = maps->ours;
  const octomap::OcTree& tree = *maps->peer;
  const std::vector<Cast> casts = random_casts(map);
  std::vector<std::pair<octomap::point3d, octomap::point3d>> peer_casts;
  peer_casts.reserve(casts.size());
  for (const Cast& cast : casts) peer_casts.emplace_back(as_peer(cast.origin_m), as_peer(cast.direction));
  octomap::point3d end;
  std::size_t alike = 0;
  std::uint64_t hits = 0;
  for (std::size_t i = 0; i < casts.size(); ++i) {
    const RayEnd ours = cast_ray(map, casts[i].origin_m, casts[i].direction, kRange_m, UnknownCells::kPass);
    const bool hit = tree.castRay(peer_casts[i].first, peer_casts[i].second, end, true, kRange_m);
    alike += end_alike(tree, ours, hit, end);
    hits += ours.what == Occupancy::kOccupied;
  }
  const double share = static_cast<double>(alike) / static_cast<double>(casts.size());
  if (share < 1.0 - kMaxOther) {
    return fail(Error::Code::kCorrupt,
                fmt::format("only {} of {} rays end where liboctomap's do", alike, casts.size()));
  }
  std::uint64_t ours_hits = 0, peer_hits = 0;
  const Side ours{[&] { ours_hits = 0; },
                  [&] {
                    for (const Cast& cast : casts) {
                      ours_hits += cast_ray(map, cast.origin_m, cast.direction, kRange_m, UnknownCells::kPass).what ==
                                   Occupancy::kOccupied;
                    }
                  }};
  const Side peer{[&] { peer_hits = 0; },
                  [&] {
                    for (const auto& [origin, direction] : peer_casts) {
                      peer_hits += tree.castRay(origin, direction, end, true, kRange_m);
                    }
                  }};
  const PairedTimes result = time_in_pairs(ours, peer);
  if (ours_hits != hits || peer_hits == 0) return fail(Error::Code::kCorrupt, "rays changed while timed");
  Row row = speed_row("cast-ray", result, {});
  row.add("input", maps->input).add("rays", std::uint64_t{casts.size()}).add("hits", hits).add("share_same", share);
  return std::vector{row};
}

Result<std::vector<Row>> leaves(const BenchOptions&) {
  const Result<TankMaps> maps = tank_maps();
  if (!maps) return tl::unexpected(maps.error());
  const OccupancyMap& map = maps->ours;
  const octomap::OcTree& tree = *maps->peer;
  LeafSums ours_sums, peer_sums;
  const Side ours{{}, [&] {
                    ours_sums = {};
                    for_each_leaf(map, [&](const Leaf& leaf) {
                      ++ours_sums.leaves;
                      ours_sums.values += static_cast<double>(leaf.belief.value());
                      ours_sums.sizes_m += leaf.edge_m();
                    });
                  }};
  const Side peer{{}, [&] {
                    peer_sums = {};
                    const auto end = tree.end_leafs();
                    for (auto leaf = tree.begin_leafs(); leaf != end; ++leaf) {
                      ++peer_sums.leaves;
                      peer_sums.values += static_cast<double>(leaf->getLogOdds());
                      peer_sums.sizes_m += leaf.getSize();
                    }
                  }};
  const PairedTimes result = time_in_pairs(ours, peer, {.pairs = 9, .min_s = 0.05});
  // The same leaves in the same order, so the same sums to the last bit.
  if (!(ours_sums == peer_sums)) {
    return fail(Error::Code::kCorrupt, fmt::format("{} leaves with sums {} and {} against {} with {} and {}",
                                                   ours_sums.leaves, ours_sums.values, ours_sums.sizes_m,
                                                   peer_sums.leaves, peer_sums.values, peer_sums.sizes_m));
  }
  Row row = speed_row("leaves", result, {});
  row.add("input", maps->input).add("leaves", ours_sums.leaves);
  return std::vector{row};
}

}  // namespace pingvox::bench
