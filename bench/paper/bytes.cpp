#include "bytes.hpp"

#include <memory>
#include <optional>

#include "bench/paired_timing.hpp"
#include "bench/speed/same_map.hpp"
#include "claim.hpp"
#include "cube.hpp"

namespace pingvox::bench {

Result<std::vector<Row>> paper_bytes(const BenchOptions&) {
  constexpr std::uint64_t kPointer = 8, kChildren = 8, kNodeOfOctomap = 16;  // pointer, float, padding
  OccupancyMap map({.resolution_m = PaperCube::kCell_m});
  octomap::OcTree tree(PaperCube::kCell_m);
  const PaperCube cube;
  cube.fill(map, Pruning::kLazy);
  cube.fill(tree, Pruning::kLazy);
  if (const auto same = check_identical(map, tree); !same) return tl::unexpected(same.error());

  const MapCounts counts = map.counts();
  const std::uint64_t eight = counts.nodes() * kChildren * kPointer, one = counts.nodes() * kPointer;
  const std::uint64_t arrays = counts.inner * kChildren * kPointer;
  const auto row = [](const char* name, Value paper, Value ours, Value octomap, Holds holds, const char* why) {
    return row_of({.name = name,
                   .section = "5.6",
                   .unit = "bytes",
                   .paper = std::move(paper),
                   .ours = std::move(ours),
                   .octomap = std::move(octomap),
                   .holds = holds,
                   .checked = true,
                   .why = why});
  };
  std::optional<OccupancyMap> fresh;
  std::unique_ptr<octomap::OcTree> fresh_tree;
  const std::uint64_t peak = peak_memory_bytes([&] {
    fresh.emplace(MapOptions{.resolution_m = PaperCube::kCell_m});
    cube.fill(*fresh, Pruning::kLazy);
  });
  const std::uint64_t peer_peak = peak_memory_bytes([&] {
    fresh_tree = std::make_unique<octomap::OcTree>(PaperCube::kCell_m);
    cube.fill(*fresh_tree, Pruning::kLazy);
  });
  return std::vector{
      row("bytes-eight-pointers", std::uint64_t{1'260'000}, eight, {}, Holds::kYes,
          "8 pointers for each of 19,769 nodes; it calls them leaves"),
      row("bytes-one-pointer", std::uint64_t{158'000}, one, {}, Holds::kYes, "1 pointer for each node, and no more"),
      row("bytes-with-arrays", std::uint64_t{158'000}, one + arrays, {}, Holds::kNo,
          "the arrays of the 5,201 inner nodes are 332,864 bytes"),
      row("bytes-with-values", {}, counts.nodes() * kNodeOfOctomap + arrays, std::uint64_t{tree.memoryUsage()},
          Holds::kNotJudged, "and the log-odds of each node; liboctomap counts its tree object, too"),
      row("bytes-of-ours", {}, std::uint64_t{map.memory_bytes()}, std::uint64_t{tree.memoryUsage()}, Holds::kNotJudged,
          "bricks of 64 cells, groups of 8 entries, no pointers; room in the pools included"),
      row("bytes-peak", {}, peak, peer_peak, Holds::kNotJudged, "of a process while it fills the cube in one batch"),
  };
}

}  // namespace pingvox::bench
