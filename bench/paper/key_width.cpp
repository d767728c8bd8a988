#include "key_width.hpp"

#include <fmt/core.h>
#include <octomap/OcTree.h>

#include <array>
#include <memory>
#include <optional>

#include "bench/paired_timing.hpp"
#include "claim.hpp"
#include "cube.hpp"
#include "geometry/internal/ray_dda.hpp"

namespace pingvox::bench {
namespace {

/// Fills the paper's cube at the centre of a lattice of any depth with lazy updates.
template <KeyWord W>
void fill(OccupancyMap& map) {
  Editor editor = map.edit();
  const LogOdds hit = LogOdds::from_probability(0.7);
  const W first = static_cast<W>((W{1} << (map.lattice().depth() - 1)) - W{PaperCube::kHalf});
  for (int x = 0; x < 2 * PaperCube::kHalf; ++x) {
    for (int y = 0; y < 2 * PaperCube::kHalf; ++y) {
      for (int z = 0; z < 2 * PaperCube::kHalf; ++z) {
        const auto word = [&](int cell) { return static_cast<W>(first + static_cast<W>(cell)); };
        editor.update(BasicKey<W>{word(x), word(y), word(z)}, hit);
      }
    }
  }
}

/// Rays from the centre to points on a sphere of 100 cells.
template <KeyWord W>
std::uint64_t walk_rays(const Lattice& lattice) {
  std::uint64_t cells = 0;
  for (int i = 0; i < 2'000; ++i) {
    const double z = -1.0 + (2.0 * i + 1.0) / 2'000.0, around = 2.399963229728653 * i;
    const double ring = std::sqrt(1.0 - z * z);
    const auto ray = dda<W>(lattice, Eigen::Vector3d(0.05, 0.05, 0.05),
                            10.0 * Eigen::Vector3d(ring * std::cos(around), ring * std::sin(around), z));
    if (!ray) return 0;
    for (const BasicKey<W> key : *ray) cells += static_cast<std::uint64_t>(key.x & 1) + 1;
  }
  return cells;
}

/// Time of work [s]: the median of `times` runs after a warm-up.
template <class Prepare, class Work>
double seconds_of(Prepare&& prepare, Work&& work) {
  return time_in_pairs({prepare, work}, {{}, [] {}}, {.pairs = 3}).ours_s;
}

}  // namespace

Result<std::vector<Row>> paper_key_width(const BenchOptions&) {
  std::vector<Row> rows;
  octomap::OcTree tree(PaperCube::kCell_m);
  const PaperCube cube;
  const double tree_s = seconds_of([&] { tree.clear(); }, [&] { cube.fill(tree, Pruning::kLazy); });
  constexpr std::array kDepths = {8, 16, 32, 64, 128};
  for (const int depth : kDepths) {
    with_key_word(depth, [&]<KeyWord W>() {
      std::optional<OccupancyMap> map;
      const double cube_s = seconds_of(
          [&] { map.emplace(MapOptions{.resolution_m = PaperCube::kCell_m, .depth = depth}); }, [&] { fill<W>(*map); });
      std::uint64_t cells = 0;
      const Lattice lattice = map->lattice();
      const double rays_s = seconds_of([] {}, [&] { cells = walk_rays<W>(lattice); });
      const std::uint64_t expected = walk_rays<std::uint16_t>(Lattice(PaperCube::kCell_m));
      const bool same = map->counts().occupied_cells == 1'000'000 && cells == expected;
      const bool is_papers = depth == 16;
      const auto row = [&](const char* what, const char* unit, Value paper, Value ours, Value octomap, Holds holds,
                           const char* why) {
        rows.push_back(row_of({.name = fmt::format("keys-{}-{}", depth, what),
                               .section = "5.1",
                               .unit = unit,
                               .paper = std::move(paper),
                               .ours = std::move(ours),
                               .octomap = std::move(octomap),
                               .holds = holds,
                               .checked = same,
                               .why = why}));
      };
      row("bytes", "bytes", is_papers ? Value(std::uint64_t{6}) : Value(), std::uint64_t{sizeof(BasicKey<W>)},
          is_papers ? Value(std::uint64_t{sizeof(octomap::OcTreeKey)}) : Value(),
          is_papers ? Holds::kYes : Holds::kNotJudged, depth > 64 ? "128 bits a component; the paper has bitsets" : "");
      row("cube", "s", {}, cube_s, is_papers ? Value(tree_s) : Value(), Holds::kNotJudged,
          depth == 16 ? "liboctomap has no other depth" : "");
      row("cube-memory", "bytes", {}, std::uint64_t{map->memory_bytes()},
          is_papers ? Value(std::uint64_t{tree.memoryUsage()}) : Value(), Holds::kNotJudged, "the tree stores no keys");
      row("rays", "s", {}, rays_s, {}, Holds::kNotJudged, "2,000 rays of 100 cells' length");
    });
  }
  const bool highest_first = Key{0x8000, 0, 0}.octant(15) == 1 && octomap::computeChildIdx({0x8000, 0, 0}, 15) == 1;
  rows.push_back(row_of({.name = "keys-first-bit",
                         .section = "5.1",
                         .unit = "bit",
                         .paper = std::uint64_t{0},
                         .ours = std::uint64_t{15},
                         .octomap = std::uint64_t{15},
                         .holds = Holds::kNo,
                         .checked = highest_first,
                         .why = "the highest bit picks the root's child; 0th holds if one counts from the top"}));
  return rows;
}

}  // namespace pingvox::bench
