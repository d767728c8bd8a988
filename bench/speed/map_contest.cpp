#include "map_contest.hpp"

#include <memory>
#include <optional>

#include "bench/paired_timing.hpp"

namespace pingvox::bench {
namespace {

MemoryOfBoth memory_of(const MapContest& contest) {
  return {peak_memory_bytes([&] {
            OccupancyMap map({.resolution_m = contest.resolution_m});
            ScanUpdate scan(map.lattice());
            contest.ours(map, scan);
          }),
          peak_memory_bytes([&] {
            octomap::OcTree tree(contest.resolution_m);
            contest.peer(tree);
          })};
}

}  // namespace

Result<Row> measured(const MapContest& contest) {
  std::optional<OccupancyMap> map;
  std::unique_ptr<octomap::OcTree> tree;
  ScanUpdate scan(Lattice(contest.resolution_m));
  const Side ours{[&] { map.emplace(MapOptions{.resolution_m = contest.resolution_m}); },
                  [&] { contest.ours(*map, scan); }};
  const Side peer{[&] { tree = std::make_unique<octomap::OcTree>(contest.resolution_m); },
                  [&] { contest.peer(*tree); }};
  for (const Side* side : {&ours, &peer}) {
    side->prepare();
    side->work();
  }
  if (const auto checked = contest.check(*map, *tree); !checked) return tl::unexpected(checked.error());
  map.reset();
  tree.reset();
  const MemoryOfBoth bytes = memory_of(contest);
  return speed_row(contest.name, time_in_pairs(ours, peer), bytes);
}

}  // namespace pingvox::bench
