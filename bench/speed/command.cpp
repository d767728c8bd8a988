#include "command.hpp"

#include <fmt/core.h>
#include <octomap/ScanGraph.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <string>

#include "bench/paired_timing.hpp"
#include "bench/process.hpp"
#include "pingvox/analysis/compare.hpp"
#include "pingvox/geometry/random.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/sim/scene.hpp"
#include "silent_stderr.hpp"

namespace pingvox::bench {
namespace {

constexpr std::size_t kScans = 20, kPoints = 50'000;
constexpr double kRange_m = 30.0;
/// Maximum fraction of cells that may differ, since liboctomap walks rays in single precision.
constexpr double kTolerated = 1e-3;

Eigen::Vector3d random_direction(Random& random) {
  for (;;) {
    const Eigen::Vector3d way(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
    if (way.norm() > 0.1 && way.norm() < 1.0) return way.normalized();
  }
}

/// Points seen by an omnidirectional scanner, in its own frame.
std::unique_ptr<octomap::Pointcloud> scan_world(const World& world, const Pose& map_from_sensor, Random& random) {
  auto cloud = std::make_unique<octomap::Pointcloud>();
  cloud->reserve(kPoints);
  while (cloud->size() < kPoints) {
    const Eigen::Vector3d direction = random_direction(random);
    const auto seen = world.first({map_from_sensor.translation(), map_from_sensor.linear() * direction}, kRange_m);
    if (!seen) continue;
    const Eigen::Vector3f point = (seen->range_m * direction).cast<float>();
    cloud->push_back(point.x(), point.y(), point.z());
  }
  return cloud;
}

/// Writes a scan graph of a route through the harbour.
Result<void> write_graph(const std::string& path) {
  const Scene scene = harbour_scene({});
  const double duration_s = length_m(scene.loop) / TravelOptions{}.speed_m_s;
  const Trajectory way = follow_route(scene.loop, duration_s, {});
  Random random(14);
  octomap::ScanGraph graph;
  for (std::size_t i = 0; i < kScans; ++i) {
    const auto pose = way.at(way.poses().front().time_s + duration_s * static_cast<double>(i) / kScans);
    if (!pose) return fail(Error::Code::kCorrupt, "the way through the harbour is too short");
    const Eigen::Vector3d at = pose->translation();
    const double yaw_rad = std::atan2(pose->linear()(1, 0), pose->linear()(0, 0));
    // The graph takes ownership of the cloud.
    graph.addNode(scan_world(scene.world, *pose, random).release(),
                  octomap::pose6d(static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()),
                                  0.0, 0.0, yaw_rad));
  }
  std::ofstream out(path, std::ios::binary);
  const SilentStderr silent_stderr;
  graph.writeBinary(out);
  if (!out.flush()) return fail(Error::Code::kIo, fmt::format("{}: cannot be written", path));
  return {};
}

Result<OccupancyMap> map_in(const std::string& path) {
  const auto file = read_file(path);
  if (!file) return tl::unexpected(file.error());
  auto map = read_map(*file);
  if (!map) return tl::unexpected(map.error());
  return std::move(map->map);
}

}  // namespace

Result<std::vector<Row>> command(const BenchOptions&) {
  const Result<std::string> program = pingvox_program();
  if (!program) return tl::unexpected(program.error());
  const Result<Scratch> scratch = Scratch::make();
  if (!scratch) return tl::unexpected(scratch.error());
  const std::string graph = scratch->path("scans.graph");
  if (const auto written = write_graph(graph); !written) return tl::unexpected(written.error());

  const std::string ours_bt = scratch->path("ours.bt"), peer_bt = scratch->path("octomap.bt");
  const std::vector<std::string> ours_words = {*program, "map", graph, "-o", ours_bt, "--resolution", "0.1", "--quiet"};
  // graph2tree always writes an .ot as well.
  const std::vector<std::string> peer_words = {"graph2tree", "-i", graph, "-o", peer_bt, "-res", "0.1"};
  if (const auto run = run_or_fail(ours_words); !run) return tl::unexpected(run.error());
  if (const auto run = run_or_fail(peer_words); !run) {
    if (run.error().code != Error::Code::kUnsupported) return tl::unexpected(run.error());
    return fail(Error::Code::kUnsupported, run.error().message + ": it comes with OctoMap (octomap-tools)");
  }
  const auto ours_map = map_in(ours_bt), peer_map = map_in(peer_bt);
  if (!ours_map) return tl::unexpected(ours_map.error());
  if (!peer_map) return tl::unexpected(peer_map.error());
  const auto found = compare_maps(*ours_map, *peer_map, Sameness::kOccupancy);
  if (!found) return tl::unexpected(found.error());
  const double differ = 1.0 - static_cast<double>(found->same) / static_cast<double>(found->cells());
  if (!(differ <= kTolerated)) {
    return fail(Error::Code::kCorrupt, fmt::format("not what graph2tree makes: {} of {} cells differ",
                                                   found->cells() - found->same, found->cells()));
  }

  bool all_well = true;
  const Side ours{{}, [&] { all_well &= run_or_fail(ours_words).has_value(); }};
  const Side peer{{}, [&] { all_well &= run_or_fail(peer_words).has_value(); }};
  Row row =
      speed_row("command", time_in_pairs(ours, peer, {.clock_s = &childrens_cpu_time_s, .warm_up = WarmUp::kNone}), {});
  if (!all_well) return fail(Error::Code::kCorrupt, "a program failed while it was timed");
  row.add("points", std::uint64_t{kScans * kPoints}).add("cells", found->cells()).add("share_that_differs", differ);
  return std::vector{row};
}

}  // namespace pingvox::bench
