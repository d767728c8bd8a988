#include "scans.hpp"

#include <fmt/core.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "bench/duel.hpp"
#include "peer.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/map/trace_ray.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "same_map.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {
namespace {

constexpr int kAcross = 32, kUp = 64;

void insert(OccupancyMap& map, ScanUpdate& scan, std::span<const PointScan> scans, const PointScanOptions& options) {
  for (const PointScan& points : scans) {
    trace_points(map.lattice(), points, options, scan);
    (void)map.apply(scan);
    scan.clear();
  }
}

struct ScanWork {
  std::string name;
  std::string input;
  double resolution_m = 0.05;
  std::vector<PointScan> scans;
  EndPoints ends = EndPoints::kExact;
  /// liboctomap walks rays in single precision with sums that drift: the most cells (as a share) that may differ.
  double tolerated = 1e-4;
};

Result<std::vector<Row>> run(const ScanWork& work) {
  const std::vector<octomap::Pointcloud> clouds = clouds_of(work.scans);
  const PeerEnds peer_ends = work.ends == EndPoints::kCells ? PeerEnds::kCells : PeerEnds::kExact;
  const PeerMode mode = faster_mode(work.resolution_m, clouds, peer_ends);
  const PointScanOptions options{.ends = work.ends};
  const MapOptions map_options{.resolution_m = work.resolution_m};
  std::optional<OccupancyMap> map;
  std::unique_ptr<octomap::OcTree> tree;
  ScanUpdate scan;
  const Side ours{[&] { map.emplace(map_options); }, [&] { insert(*map, scan, work.scans, options); }};
  const Side peer{[&] { tree = std::make_unique<octomap::OcTree>(work.resolution_m); },
                  [&] { insert(*tree, clouds, peer_ends, mode); }};
  ours.prepare();
  ours.work();
  peer.prepare();
  peer.work();
  const MapDifference found = difference(*map, *tree);
  if (found.share() > work.tolerated) {
    return fail(Error::Code::kCorrupt,
                fmt::format("not what liboctomap makes: {} of {} cells differ", found.differs, found.cells));
  }
  map.reset();
  tree.reset();
  const std::uint64_t ours_bytes = peak_memory_bytes([&] {
    OccupancyMap fresh(map_options);
    ScanUpdate fresh_scan;
    insert(fresh, fresh_scan, work.scans, options);
  });
  const std::uint64_t peer_bytes = peak_memory_bytes([&] {
    octomap::OcTree fresh(work.resolution_m);
    insert(fresh, clouds, peer_ends, mode);
  });
  const DuelResult result = duel(ours, peer);
  Row row = speed_row(work.name, result, ours_bytes, peer_bytes);
  row.add("input", work.input).add("cells", found.cells).add("cells_that_differ", found.differs);
  return std::vector{row};
}

Result<std::vector<PointScan>> bundles(std::size_t sweeps, std::string& input) {
  const Result<TankEchoes> tank = tank_echoes();
  if (!tank) return tl::unexpected(tank.error());
  input = tank->input;
  std::vector<PointScan> scans;
  for (std::size_t i = 0; i < sweeps; ++i) scans.push_back(bundles_of(tank->sweeps[i], kAcross, kUp));
  return scans;
}

Result<std::vector<Row>> run_bundles(ScanWork work, std::size_t sweeps) {
  Result<std::vector<PointScan>> scans = bundles(sweeps, work.input);
  if (!scans) return tl::unexpected(scans.error());
  work.scans = std::move(*scans);
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
  // Rays from a corner of a cell to middles of cells go through edges and corners, where rounding decides.
  return run_bundles({.name = "tank-3d-cells", .input = {}, .scans = {}, .ends = EndPoints::kCells, .tolerated = 0.02},
                     3);
}

Result<std::vector<Row>> tank_fine(const BenchOptions&) {
  return run_bundles({.name = "tank-fine", .input = {}, .resolution_m = 0.0125, .scans = {}}, 1);
}

}  // namespace pingvox::bench
