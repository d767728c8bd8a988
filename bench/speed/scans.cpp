#include "scans.hpp"

#include <string>
#include <vector>

#include "insert_scans.hpp"
#include "map_contest.hpp"
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
  /// liboctomap walks rays in single precision with sums that drift: the most cells (as a share) that may differ.
  double tolerated = 1e-4;
};

Result<std::vector<Row>> run(const ScanWork& work) {
  const std::vector<octomap::Pointcloud> clouds = clouds_of(work.scans);
  const PeerEnds peer_ends = work.ends == EndPoints::kCells ? PeerEnds::kCells : PeerEnds::kExact;
  const auto fill_peer = [&](octomap::OcTree& tree, PeerMode mode) { insert(tree, clouds, peer_ends, mode); };
  const PeerMode mode = faster_mode(work.resolution_m, fill_peer);
  MapDifference found;
  Result<Row> row = measured(
      {.name = work.name,
       .resolution_m = work.resolution_m,
       .ours = [&](OccupancyMap& map, ScanUpdate& scan) { insert(map, scan, work.scans, {.ends = work.ends}); },
       .peer = [&](octomap::OcTree& tree) { fill_peer(tree, mode); },
       .check = [&](const OccupancyMap& map, const octomap::OcTree& tree) -> Result<void> {
         const Result<MapDifference> difference = alike(map, tree, work.tolerated);
         if (!difference) return tl::unexpected(difference.error());
         found = *difference;
         return {};
       }});
  if (!row) return tl::unexpected(row.error());
  row->add("input", work.input).add("cells", found.cells).add("cells_that_differ", found.differs);
  return std::vector{*row};
}

Result<std::vector<Row>> run_bundles(ScanWork work, std::size_t sweeps) {
  Result<TankBundles> bundles = tank_bundles(sweeps);
  if (!bundles) return tl::unexpected(bundles.error());
  work.input = bundles->input;
  work.scans = std::move(bundles->scans);
  return run(work);
}

}  // namespace

Result<std::vector<Row>> tank_2d(const BenchOptions&) {
  const Result<TankEchoes> tank = tank_echoes();
  if (!tank) return tl::unexpected(tank.error());
  // Rays at exactly 45 degrees from a corner of a cell go through corners all the way, where rounding decides.
  ScanWork work{.name = "tank-2d",
                .input = tank->input,
                .resolution_m = 0.0125,
                .scans = {},
                .ends = EndPoints::kExact,
                .tolerated = 0.01};
  for (const auto& sweep : tank->sweeps) work.scans.push_back(rays_of(sweep));
  return run(work);
}

Result<std::vector<Row>> tank_3d(const BenchOptions&) {
  return run_bundles({.name = "tank-3d", .input = {}, .scans = {}}, 3);
}

Result<std::vector<Row>> tank_3d_cells(const BenchOptions&) {
  // Rays from a corner of a cell to middles of cells go through edges and corners, where rounding decides: 0.24 % are
  // not the same.
  return run_bundles({.name = "tank-3d-cells", .input = {}, .scans = {}, .ends = EndPoints::kCells, .tolerated = 0.005},
                     3);
}

Result<std::vector<Row>> tank_fine(const BenchOptions&) {
  return run_bundles({.name = "tank-fine", .input = {}, .resolution_m = 0.0125, .scans = {}}, 1);
}

}  // namespace pingvox::bench
