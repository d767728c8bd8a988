#include "cone.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <span>
#include <vector>

#include "map_contest.hpp"
#include "peer.hpp"
#include "pingvox/mapping/beam_tracer.hpp"
#include "same_map.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05;
constexpr std::size_t kSweeps = 3;
/// Of the cells that the bundles touch, the most (as a share) that the cones may leave out: liboctomap walks rays in
/// single precision with sums that drift.
constexpr double kMaxMissing = 1e-3;
/// How many more the cones may touch, as a share: those between the rays, and those that the cone's edge cuts.
constexpr double kMaxMore = 0.15;

/// An echo as the beam model takes it.
struct Cone {
  Beam beam;
  Echo echo;
};
using ConeSweep = std::vector<Cone>;

std::vector<ConeSweep> cones_of(const TankEchoes& tank) {
  std::vector<ConeSweep> sweeps;
  for (const auto& sweep : std::span(tank.sweeps).first(std::min(kSweeps, tank.sweeps.size()))) {
    ConeSweep& cones = sweeps.emplace_back();
    for (const BeamEcho& echo : sweep) {
      Cone& cone = cones.emplace_back();
      cone.beam.bearing_rad = echo.bearing_rad;
      // Free up to the echo's range, and as wide as it may come from: what the bundle of rays says.
      cone.beam.bin_length_m = echo.range_m;
      cone.echo.first = 1;
      cone.echo.range_m = echo.range_m;
      cone.echo.intensity = echo.intensity;
    }
  }
  return sweeps;
}

void insert(OccupancyMap& map, ScanUpdate& scan, std::span<const ConeSweep> sweeps) {
  const BeamModelOptions model{.shape = BeamShape::kCone, .free_share = 1.0, .hit_from = HitFrom::kFixed};
  BeamTracer tracer(map.lattice(), model);
  for (const ConeSweep& sweep : sweeps) {
    for (const Cone& cone : sweep) {
      tracer.trace(Pose::Identity(), cone.beam, cone.echo, scan);
    }
    (void)map.apply(scan);
    scan.clear();
  }
}

/// How the cells of the cones stand to those of the bundles, as shares of these.
struct ConeCells {
  std::uint64_t cells = 0;  ///< of either
  double missing = 0.0, more = 0.0;
};

Result<ConeCells> compared(const OccupancyMap& map, const octomap::OcTree& tree) {
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
  const std::vector<ConeSweep> sweeps = cones_of(*tank);
  const std::vector<octomap::Pointcloud> clouds = clouds_of(bundles->scans);
  const auto fill_peer = [&](octomap::OcTree& tree, PeerMode mode) { insert(tree, clouds, PeerEnds::kExact, mode); };
  const PeerMode mode = faster_mode(kCell_m, fill_peer);
  ConeCells found;
  Result<Row> row = measured({.name = "tank-cone",
                              .resolution_m = kCell_m,
                              .ours = [&](OccupancyMap& map, ScanUpdate& scan) { insert(map, scan, sweeps); },
                              .peer = [&](octomap::OcTree& tree) { fill_peer(tree, mode); },
                              .check = [&](const OccupancyMap& map, const octomap::OcTree& tree) -> Result<void> {
                                const Result<ConeCells> cells = compared(map, tree);
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
