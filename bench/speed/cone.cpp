#include "cone.hpp"

#include <fmt/core.h>

#include <vector>

#include "beam_sweeps.hpp"
#include "map_benchmark.hpp"
#include "peer.hpp"
#include "same_map.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05;
constexpr std::size_t kSweeps = 3;
/// Maximum fraction of the bundles' cells that may be missing in the cones, since liboctomap walks rays in single
/// precision.
constexpr double kMaxMissing = 1e-3;
/// Maximum fraction of additional cells of the cones: between the rays, and at the edge of the cone.
constexpr double kMaxMore = 0.15;

/// Cells of the cones relative to those of the bundles.
struct ConeCells {
  std::uint64_t cells = 0;  ///< in total
  double missing = 0.0, more = 0.0;
};

Result<ConeCells> compare(const OccupancyMap& map, const octomap::OcTree& tree) {
  const MapDifference found = difference(map, tree);
  const auto peer_cells = static_cast<double>(found.cells - found.only_ours);
  const ConeCells shares{found.cells, static_cast<double>(found.only_peer) / peer_cells,
                         static_cast<double>(found.only_ours) / peer_cells};
  if (shares.missing <= kMaxMissing && shares.more <= kMaxMore) return shares;
  return fail(Error::Code::kCorrupt,
              fmt::format("of the {} cells of the bundles {} are not in the cones, which have {} others", peer_cells,
                          found.only_peer, found.only_ours));
}

}  // namespace

Result<std::vector<Row>> tank_cone(const BenchOptions&) {
  const Result<TankEchoes> tank = tank_echoes();
  if (!tank) return tl::unexpected(tank.error());
  const Result<TankBundles> bundles = tank_bundles(kSweeps);
  if (!bundles) return tl::unexpected(bundles.error());
  const std::vector<BeamSweep> sweeps = beam_sweeps(*tank, kSweeps);
  const BeamModelOptions model{.shape = BeamShape::kCone, .free_share = 1.0, .hit_from = HitFrom::kFixed};
  const std::vector<PeerScan> scans = peer_scans(bundles->scans);
  const auto fill_peer = [&](octomap::OcTree& tree, PeerMode mode) { insert(tree, scans, PeerEnds::kExact, mode); };
  const PeerMode mode = faster_mode(kCell_m, fill_peer);
  ConeCells found;
  Result<Row> row = measure({.name = "tank-cone",
                             .resolution_m = kCell_m,
                             .ours = [&](OccupancyMap& map, ScanUpdate& scan) { insert(map, scan, sweeps, model); },
                             .peer = [&](octomap::OcTree& tree) { fill_peer(tree, mode); },
                             .check = [&](const OccupancyMap& map, const octomap::OcTree& tree) -> Result<void> {
                               const Result<ConeCells> cells = compare(map, tree);
                               if (!cells) return tl::unexpected(cells.error());
                               found = *cells;
                               return {};
                             }});
  if (!row) return tl::unexpected(row.error());
  row->add("input", tank->input)
      .add("cells", found.cells)
      .add("share_missing", found.missing)
      .add("share_more", found.more);
  return std::vector{*row};
}

}  // namespace pingvox::bench
