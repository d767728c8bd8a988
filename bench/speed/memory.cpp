#include "memory.hpp"

#include <algorithm>
#include <memory>
#include <numeric>

#include "bench/paired_timing.hpp"
#include "insert_scans.hpp"
#include "peer.hpp"
#include "same_map.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05;
constexpr int kRuns = 3;

}  // namespace

Result<std::vector<Row>> memory(const BenchOptions&) {
  const Result<TankBundles> bundles = tank_bundles(3);
  if (!bundles) return tl::unexpected(bundles.error());
  const std::vector<PeerScan> peer_clouds = peer_scans(bundles->scans);
  const auto ours = [&] {
    auto map = std::make_shared<OccupancyMap>(MapOptions{.resolution_m = kCell_m});
    ScanUpdate scan(map->lattice());
    insert(*map, scan, bundles->scans);
    return map;
  };
  const auto peer = [&] {
    auto tree = std::make_shared<octomap::OcTree>(kCell_m);
    insert(*tree, peer_clouds, PeerEnds::kExact, PeerMode::kEager);
    return tree;
  };
  const Result<MapDifference> found = check_equal(*ours(), *peer(), bundles->scans);
  if (!found) return tl::unexpected(found.error());
  std::vector<double> ours_bytes, peer_bytes, ratios;
  for (int run = 0; run < kRuns; ++run) {
    ours_bytes.push_back(static_cast<double>(live_memory_bytes(ours)));
    peer_bytes.push_back(static_cast<double>(live_memory_bytes(peer)));
    if (!(ours_bytes.back() > 0.0 && peer_bytes.back() > 0.0)) {
      return fail(Error::Code::kUnsupported, "this system does not tell how much memory a process holds");
    }
    ratios.push_back(peer_bytes.back() / ours_bytes.back());
  }
  const double bytes = median(ours_bytes), octomap_bytes = median(peer_bytes);
  Row row;
  row.add("name", "memory")
      .add_truth("checked", true)
      .add_nothing("ours_s")
      .add_nothing("octomap_s")
      .add("ratio", median(ratios))
      .add("ratio_min", *std::min_element(ratios.begin(), ratios.end()))
      .add("ratio_max", *std::max_element(ratios.begin(), ratios.end()))
      .add("ours_bytes", static_cast<std::uint64_t>(bytes))
      .add("octomap_bytes", static_cast<std::uint64_t>(octomap_bytes))
      .add("share", bytes / octomap_bytes)
      .add("input", bundles->input)
      .add("cells", found->cells);
  return std::vector{row};
}

}  // namespace pingvox::bench
