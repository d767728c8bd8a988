#include "cone.hpp"

#include <fmt/core.h>

#include <memory>
#include <optional>
#include <span>

#include "bench/duel.hpp"
#include "peer.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "same_map.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05;
constexpr std::size_t kSweeps = 3;
/// Of the cells that the bundles touch, the most (as a share) that the cones may leave out: liboctomap walks rays in
/// single precision with sums that drift.
constexpr double kMostMissing = 1e-3;
/// How many more the cones may touch, as a share: those between the rays, and those that the cone's edge cuts.
constexpr double kMostMore = 0.15;

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
  for (const ConeSweep& sweep : sweeps) {
    for (const Cone& cone : sweep) {
      trace_beam(map.lattice(), Pose::Identity(), cone.beam, cone.echo, model, scan);
    }
    (void)map.apply(scan);
    scan.clear();
  }
}

}  // namespace

Result<std::vector<Row>> tank_cone(const BenchOptions&) {
  const Result<TankEchoes> tank = tank_echoes();
  if (!tank) return tl::unexpected(tank.error());
  const Result<TankBundles> bundles = tank_bundles(kSweeps);
  if (!bundles) return tl::unexpected(bundles.error());
  const std::vector<ConeSweep> sweeps = cones_of(*tank);
  const std::vector<octomap::Pointcloud> clouds = clouds_of(bundles->scans);
  const PeerMode mode = faster_mode(kCell_m, clouds, PeerEnds::kExact);
  const MapOptions map_options{.resolution_m = kCell_m};
  std::optional<OccupancyMap> map;
  std::unique_ptr<octomap::OcTree> tree;
  ScanUpdate scan;
  const Side ours{[&] { map.emplace(map_options); }, [&] { insert(*map, scan, sweeps); }};
  const Side peer{[&] { tree = std::make_unique<octomap::OcTree>(kCell_m); },
                  [&] { insert(*tree, clouds, PeerEnds::kExact, mode); }};
  ours.prepare();
  ours.work();
  peer.prepare();
  peer.work();
  const MapDifference found = difference(*map, *tree);
  const auto peer_cells = static_cast<double>(found.cells - found.only_ours);
  const double missing = static_cast<double>(found.only_peer) / peer_cells;
  const double more = static_cast<double>(found.only_ours) / peer_cells;
  if (!(missing <= kMostMissing && more <= kMostMore)) {
    return fail(Error::Code::kCorrupt, fmt::format("of the {} cells of the bundles {} are not in the cones, which have "
                                                   "{} others",
                                                   peer_cells, found.only_peer, found.only_ours));
  }
  map.reset();
  tree.reset();
  const DuelMemory bytes{peak_memory_bytes([&] {
                           OccupancyMap fresh(map_options);
                           ScanUpdate fresh_scan;
                           insert(fresh, fresh_scan, sweeps);
                         }),
                         peak_memory_bytes([&] {
                           octomap::OcTree fresh(kCell_m);
                           insert(fresh, clouds, PeerEnds::kExact, mode);
                         })};
  Row row = speed_row("tank-cone", duel(ours, peer), bytes);
  row.add("input", tank->input).add("cells", found.cells).add("share_missing", missing).add("share_more", more);
  return std::vector{row};
}

}  // namespace pingvox::bench
