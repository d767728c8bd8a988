#include "cube.hpp"

#include <octomap/OcTree.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "bench/duel.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "same_map.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.01;
constexpr std::uint16_t kFirst = 32768, kEdge = 100;

/// All cells of the cube, in both libraries' keys: what the sides are given.
struct Cells {
  std::vector<Key> ours;
  std::vector<octomap::OcTreeKey> peer;
};

Cells cells_of_cube() {
  Cells cells;
  const auto word = [](std::uint16_t n) { return static_cast<std::uint16_t>(kFirst + n); };
  for (std::uint16_t x = 0; x < kEdge; ++x) {
    for (std::uint16_t y = 0; y < kEdge; ++y) {
      for (std::uint16_t z = 0; z < kEdge; ++z) {
        cells.ours.push_back({word(x), word(y), word(z)});
        cells.peer.emplace_back(word(x), word(y), word(z));
      }
    }
  }
  return cells;
}

void fill_each(OccupancyMap& map, std::span<const Key> cells) {
  Editor editor = map.edit(Pruning::kEachUpdate);
  const LogOdds hit = LogOdds::from_probability(0.7);
  for (const Key& cell : cells) editor.update(cell, hit);
}

void fill_at_once(OccupancyMap& map, std::span<const Key> cells) {
  (void)map.update(cells, LogOdds::from_probability(0.7));
}

/// The library's own value of a hit is a double's logarithm: the same number is handed in.
void fill(octomap::OcTree& tree, std::span<const octomap::OcTreeKey> cells, bool lazy) {
  const float hit = LogOdds::from_probability(0.7).value();
  for (const octomap::OcTreeKey& cell : cells) tree.updateNode(cell, hit, lazy);
  if (!lazy) return;
  tree.updateInnerOccupancy();
  tree.prune();
}

Result<std::vector<Row>> cube(std::string name, void (*fill_ours)(OccupancyMap&, std::span<const Key>), bool lazy) {
  const Cells cells = cells_of_cube();
  std::optional<OccupancyMap> map;
  std::unique_ptr<octomap::OcTree> tree;
  const Side ours{[&] { map.emplace(MapOptions{.resolution_m = kCell_m}); }, [&] { fill_ours(*map, cells.ours); }};
  const Side peer{[&] { tree = std::make_unique<octomap::OcTree>(kCell_m); }, [&] { fill(*tree, cells.peer, lazy); }};
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
  return std::vector{speed_row(std::move(name), result, {memory(ours), memory(peer)})};
}

}  // namespace

Result<std::vector<Row>> cube_each(const BenchOptions&) {
  return cube("cube-each", &fill_each, false);
}

Result<std::vector<Row>> cube_lazy(const BenchOptions&) {
  return cube("cube-lazy", &fill_at_once, true);
}

}  // namespace pingvox::bench
