#include "scans.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "beam_sweeps.hpp"
#include "insert_scans.hpp"
#include "lidar_scans.hpp"
#include "map_benchmark.hpp"
#include "multibeam_scans.hpp"
#include "peer.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {
namespace {

struct ScanWork {
  std::string name;
  std::string input;
  double resolution_m = 0.05;
  std::vector<RayCloud> scans;
  EndPoints ends = EndPoints::kExact;
  /// Our side; empty: insert the scans as clouds.
  std::function<void(OccupancyMap&, ScanUpdate&)> ours;
};

/// The rays that both libraries trace with EndPoints::kCells.
std::vector<RayCloud> rays_to_cells(const Lattice& lattice, const std::vector<RayCloud>& scans) {
  std::vector<RayCloud> all;
  for (const RayCloud& scan : scans) {
    std::set<Key> cells;
    for (const Eigen::Vector3f& end_m : scan.ends_m) {
      if (const auto key = lattice.key_of(end_m.cast<double>())) cells.insert(*key);
    }
    RayCloud& rays = all.emplace_back(RayCloud{scan.origin_m, {}});
    for (const Key& cell : cells) rays.ends_m.emplace_back(lattice.centre_of(cell).cast<float>());
  }
  return all;
}

Result<std::vector<Row>> run(const ScanWork& work) {
  const std::vector<PeerScan> scans = peer_scans(work.scans);
  const PeerEnds peer_ends = work.ends == EndPoints::kCells ? PeerEnds::kCells : PeerEnds::kExact;
  const auto fill_peer = [&](octomap::OcTree& tree, PeerMode mode) { insert(tree, scans, peer_ends, mode); };
  const PeerMode mode = faster_mode(work.resolution_m, fill_peer);
  const auto as_clouds = [&](OccupancyMap& map, ScanUpdate& scan) {
    insert(map, scan, work.scans, {.ends = work.ends});
  };
  MapDifference found;
  Result<Row> row = measure({.name = work.name,
                             .resolution_m = work.resolution_m,
                             .ours = work.ours ? work.ours : as_clouds,
                             .peer = [&](octomap::OcTree& tree) { fill_peer(tree, mode); },
                             .check = [&](const OccupancyMap& map, const octomap::OcTree& tree) -> Result<void> {
                               const Result<MapDifference> difference =
                                   work.ends == EndPoints::kCells
                                       ? check_equal(map, tree, rays_to_cells(map.lattice(), work.scans))
                                       : check_equal(map, tree, work.scans);
                               if (!difference) return tl::unexpected(difference.error());
                               found = *difference;
                               return {};
                             }});
  if (!row) return tl::unexpected(row.error());
  std::uint64_t rays = 0;
  for (const RayCloud& scan : work.scans) rays += scan.ends_m.size();
  row->add("input", work.input)
      .add("scans", std::uint64_t{work.scans.size()})
      .add("rays", rays)
      .add("resolution_m", work.resolution_m)
      .add("cells", found.cells)
      .add("cells_that_differ", found.differs);
  return std::vector{*row};
}

Result<std::vector<Row>> run_bundles(ScanWork work, std::size_t sweeps) {
  Result<TankBundles> bundles = tank_bundles(sweeps);
  if (!bundles) return tl::unexpected(bundles.error());
  work.input = bundles->input;
  work.scans = std::move(bundles->scans);
  return run(work);
}

Result<std::vector<Row>> run_lidar(ScanWork work, const LidarOptions& lidar) {
  work.input = "simulated";
  work.scans = lidar_scans(lidar);
  return run(work);
}

}  // namespace

Result<std::vector<Row>> tank_2d(const BenchOptions&) {
  const Result<TankEchoes> tank = tank_echoes();
  if (!tank) return tl::unexpected(tank.error());
  const std::vector<BeamSweep> sweeps = beam_sweeps(*tank, std::numeric_limits<std::size_t>::max());
  const BeamModelOptions model{.shape = BeamShape::kRay, .hit_from = HitFrom::kFixed};
  ScanWork work{.name = "tank-2d",
                .input = tank->input,
                .resolution_m = 0.0125,
                .scans = {},
                .ends = EndPoints::kExact,
                .ours = [&](OccupancyMap& map, ScanUpdate& scan) { insert(map, scan, sweeps, model); }};
  for (const auto& sweep : tank->sweeps) work.scans.push_back(rays_of(sweep));
  return run(work);
}

Result<std::vector<Row>> tank_3d(const BenchOptions&) {
  return run_bundles({.name = "tank-3d", .input = {}, .scans = {}, .ours = {}}, 3);
}

Result<std::vector<Row>> tank_3d_cells(const BenchOptions&) {
  return run_bundles({.name = "tank-3d-cells", .input = {}, .scans = {}, .ends = EndPoints::kCells, .ours = {}}, 3);
}

Result<std::vector<Row>> tank_fine(const BenchOptions&) {
  return run_bundles({.name = "tank-fine", .input = {}, .resolution_m = 0.0125, .scans = {}, .ours = {}}, 1);
}

Result<std::vector<Row>> multibeam(const BenchOptions&) {
  Result<MultibeamScans> line = multibeam_scans();
  if (!line) return tl::unexpected(line.error());
  return run({.name = "multibeam",
              .input = std::move(line->input),
              .resolution_m = 0.1,
              .scans = std::move(line->scans),
              .ours = {}});
}

Result<std::vector<Row>> lidar_16(const BenchOptions&) {
  return run_lidar({.name = "lidar-16", .input = {}, .resolution_m = 0.1, .scans = {}, .ours = {}},
                   {.rings = 16, .steps = 1800, .height_deg = 30.0, .scans = 4});
}

Result<std::vector<Row>> lidar_128(const BenchOptions&) {
  return run_lidar({.name = "lidar-128", .input = {}, .resolution_m = 0.1, .scans = {}, .ours = {}},
                   {.rings = 128, .steps = 1024, .height_deg = 45.0, .scans = 1});
}

}  // namespace pingvox::bench
