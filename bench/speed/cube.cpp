#include "cube.hpp"

#include <span>
#include <utility>
#include <vector>

#include "map_benchmark.hpp"
#include "peer.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.01;
constexpr std::uint16_t kFirst = 32768, kEdge = 100;

/// All cells of the cube as keys of both libraries.
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

/// Uses our log-odds of a hit, since liboctomap computes its own in double precision.
void fill(octomap::OcTree& tree, std::span<const octomap::OcTreeKey> cells, PeerMode mode) {
  const float hit = LogOdds::from_probability(0.7).value();
  for (const octomap::OcTreeKey& cell : cells) tree.updateNode(cell, hit, mode == PeerMode::kLazy);
  synchronize(tree, mode);
}

Result<std::vector<Row>> cube(std::string name, void (*fill_ours)(OccupancyMap&, std::span<const Key>), PeerMode mode) {
  const Cells cells = cells_of_cube();
  const Result<Row> row = measure({.name = std::move(name),
                                   .resolution_m = kCell_m,
                                   .ours = [&](OccupancyMap& map, ScanUpdate&) { fill_ours(map, cells.ours); },
                                   .peer = [&](octomap::OcTree& tree) { fill(tree, cells.peer, mode); }});
  if (!row) return tl::unexpected(row.error());
  return std::vector{*row};
}

}  // namespace

Result<std::vector<Row>> cube_each(const BenchOptions&) {
  return cube("cube-each", &fill_each, PeerMode::kEager);
}

Result<std::vector<Row>> cube_lazy(const BenchOptions&) {
  return cube("cube-lazy", &fill_at_once, PeerMode::kLazy);
}

}  // namespace pingvox::bench
