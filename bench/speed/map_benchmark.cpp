#include "map_benchmark.hpp"

#include <memory>
#include <optional>

#include "bench/paired_timing.hpp"

namespace pingvox::bench {
namespace {

MemoryOfBoth memory_of(const MapBenchmark& benchmark) {
  return {peak_memory_bytes([&] {
            OccupancyMap map({.resolution_m = benchmark.resolution_m});
            ScanUpdate scan(map.lattice());
            benchmark.ours(map, scan);
          }),
          peak_memory_bytes([&] {
            octomap::OcTree tree(benchmark.resolution_m);
            benchmark.peer(tree);
          })};
}

}  // namespace

Result<Row> measure(const MapBenchmark& benchmark) {
  std::optional<OccupancyMap> map;
  std::unique_ptr<octomap::OcTree> tree;
  ScanUpdate scan(Lattice(benchmark.resolution_m));
  const Side ours{[&] { map.emplace(MapOptions{.resolution_m = benchmark.resolution_m}); },
                  [&] { benchmark.ours(*map, scan); }};
  const Side peer{[&] { tree = std::make_unique<octomap::OcTree>(benchmark.resolution_m); },
                  [&] { benchmark.peer(*tree); }};
  for (const Side* side : {&ours, &peer}) {
    side->prepare();
    side->work();
  }
  if (const auto checked = benchmark.check(*map, *tree); !checked) return tl::unexpected(checked.error());
  map.reset();
  tree.reset();
  const MemoryOfBoth bytes = memory_of(benchmark);
  return speed_row(benchmark.name, time_in_pairs(ours, peer), bytes);
}

}  // namespace pingvox::bench
