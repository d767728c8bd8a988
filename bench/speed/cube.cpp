#include "cube.hpp"

#include <octomap/OcTree.h>

#include <memory>
#include <optional>
#include <vector>

#include "bench/duel.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "same_map.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.01;
constexpr std::uint16_t kFirst = 32768, kEdge = 100;

template <class F>
void for_each_cell(F&& f) {
  for (std::uint16_t x = 0; x < kEdge; ++x) {
    for (std::uint16_t y = 0; y < kEdge; ++y) {
      for (std::uint16_t z = 0; z < kEdge; ++z) {
        f(static_cast<std::uint16_t>(kFirst + x), static_cast<std::uint16_t>(kFirst + y),
          static_cast<std::uint16_t>(kFirst + z));
      }
    }
  }
}

void fill(OccupancyMap& map, Pruning pruning) {
  Editor editor = map.edit(pruning);
  const LogOdds hit = LogOdds::from_probability(0.7);
  for_each_cell([&](std::uint16_t x, std::uint16_t y, std::uint16_t z) { editor.update(Key{x, y, z}, hit); });
}

/// The library's own value of a hit is a double's logarithm: the same number is handed in.
void fill(octomap::OcTree& tree, bool lazy) {
  const float hit = LogOdds::from_probability(0.7).value();
  for_each_cell([&](std::uint16_t x, std::uint16_t y, std::uint16_t z) {
    tree.updateNode(octomap::OcTreeKey(x, y, z), hit, lazy);
  });
  if (!lazy) return;
  tree.updateInnerOccupancy();
  tree.prune();
}

Result<std::vector<Row>> cube(const std::string& name, Pruning pruning, bool lazy) {
  std::optional<OccupancyMap> map;
  std::unique_ptr<octomap::OcTree> tree;
  const Side ours{[&] { map.emplace(MapOptions{.resolution_m = kCell_m}); }, [&] { fill(*map, pruning); }};
  const Side peer{[&] { tree = std::make_unique<octomap::OcTree>(kCell_m); }, [&] { fill(*tree, lazy); }};
  ours.prepare();
  ours.work();
  peer.prepare();
  peer.work();
  if (const auto same = same_to_the_bit(*map, *tree); !same) return tl::unexpected(same.error());
  const DuelResult result = duel(ours, peer);
  map.reset();
  tree.reset();
  const auto memory = [](const Side& side) {
    return peak_memory_bytes([&] {
      side.prepare();
      side.work();
    });
  };
  return std::vector{speed_row(name, result, {memory(ours), memory(peer)})};
}

}  // namespace

Result<std::vector<Row>> cube_each(const BenchOptions&) {
  return cube("cube-each", Pruning::kEachUpdate, false);
}

Result<std::vector<Row>> cube_lazy(const BenchOptions&) {
  return cube("cube-lazy", Pruning::kWhenSettled, true);
}

}  // namespace pingvox::bench
