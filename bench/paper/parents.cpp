#include "parents.hpp"

#include <fmt/core.h>

#include <cmath>
#include <string>

#include "claim.hpp"
#include "tank_logs.hpp"

namespace pingvox::bench {
namespace {

constexpr int kDepth = 12;

/// Sums over the leaves below a node.
struct Below {
  std::uint64_t occupied = 0, free = 0;
  double squares = 0.0;  ///< of the differences to the node's value
};

void add_leaves(const NodeView& node, int levels, float block_value, Below& below) {
  if (!node.is_leaf()) {
    for (int octant = 0; octant < 8; ++octant) {
      if (const auto child = node.child(octant)) add_leaves(*child, levels, block_value, below);
    }
    return;
  }
  const std::uint64_t cells = std::uint64_t{1} << (3 * (levels - node.depth()));
  (classify(node.belief()) == Occupancy::kOccupied ? below.occupied : below.free) += cells;
  const double off = double{block_value} - double{node.belief().value()};
  below.squares += off * off * static_cast<double>(cells);
}

struct Sum {
  CoarseView view;
  std::uint64_t cells = 0;
  double squares = 0.0;
};

void add_blocks(const NodeView& node, int depth, int levels, Sum& sum) {
  if (!node.is_leaf() && node.depth() < depth) {
    for (int octant = 0; octant < 8; ++octant) {
      if (const auto child = node.child(octant)) add_blocks(*child, depth, levels, sum);
    }
    return;
  }
  Below below;
  add_leaves(node, levels, node.belief().value(), below);
  const bool is_occupied = classify(node.belief()) == Occupancy::kOccupied;
  CoarseView& view = sum.view;
  ++view.blocks;
  view.called_occupied += is_occupied ? 1 : 0;
  view.free_cells += below.free;
  if (is_occupied) view.free_given_up += below.free;
  if (below.occupied > 0) {
    ++view.with_obstacle;
    view.called_free += is_occupied ? 0 : 1;
  }
  sum.cells += below.occupied + below.free;
  sum.squares += below.squares;
}

Result<OccupancyMap> map_of(const TankLog& log, Parents parents) {
  OccupancyMap map({.parents = parents});
  BuildOptions options;
  options.model.shape = BeamShape::kCone;
  BeamsInMemory beams(log.beams);
  const auto report = build_map(beams, Trajectory::still(Pose::Identity()), options, map);
  if (!report) return tl::unexpected(report.error());
  return map;
}

Result<void> add_rows(const TankLog& log, std::vector<Row>& rows) {
  const auto max_map = map_of(log, Parents::kMax), mean_map = map_of(log, Parents::kMean);
  if (!max_map) return tl::unexpected(max_map.error());
  if (!mean_map) return tl::unexpected(mean_map.error());
  const CoarseView max = coarse_view(*max_map, kDepth), mean = coarse_view(*mean_map, kDepth);
  const bool same_leaves = max.blocks == mean.blocks && max.with_obstacle == mean.with_obstacle &&
                           max.free_cells == mean.free_cells && max.with_obstacle > 0;
  const auto row = [&](const char* what, const char* unit, Value paper, double ours, Holds holds, std::string why) {
    rows.push_back(row_of({.name = fmt::format("parents-{}-{}", what, log.name),
                           .section = "5.3.1",
                           .unit = unit,
                           .paper = std::move(paper),
                           .ours = ours,
                           .octomap = {},
                           .holds = holds,
                           .checked = same_leaves,
                           .why = std::move(why)}));
  };
  const double max_gone = per_cent(max.called_free, max.with_obstacle);
  const double mean_gone = per_cent(mean.called_free, mean.with_obstacle);
  row("max-obstacles-lost", "% of blocks with one", "conservative", max_gone,
      max_gone == 0.0 ? Holds::kYes : Holds::kNo,
      fmt::format("{} of {} blocks of 0.8 m hold an occupied cell", max.with_obstacle, max.blocks));
  row("mean-obstacles-lost", "% of blocks with one", "optimistic", mean_gone,
      mean_gone > max_gone ? Holds::kYes : Holds::kNo,
      fmt::format("a planner at depth 12 drives through {} of {} blocks", mean.called_free, mean.with_obstacle));
  row("max-free-given-up", "% of free cells", {}, per_cent(max.free_given_up, max.free_cells), Holds::kNotJudged,
      "free, but in a block that is called occupied");
  row("mean-free-given-up", "% of free cells", {}, per_cent(mean.free_given_up, mean.free_cells), Holds::kNotJudged,
      "free, but in a block that is called occupied");
  row("max-error", "log-odds, rms", {}, max.error, Holds::kNotJudged, "of a block's value, over its known cells");
  row("mean-error", "log-odds, rms", "least", mean.error, mean.error < max.error ? Holds::kYes : Holds::kNo,
      "of a block's value, over its known cells");
  return {};
}

}  // namespace

CoarseView coarse_view(const OccupancyMap& map, int depth) {
  Sum sum;
  if (const auto root = map.root()) add_blocks(*root, depth, map.lattice().depth(), sum);
  sum.view.error = sum.cells == 0 ? 0.0 : std::sqrt(sum.squares / static_cast<double>(sum.cells));
  return sum.view;
}

Result<std::vector<Row>> paper_parents(const BenchOptions&) {
  const auto logs = tank_logs();
  if (!logs) return tl::unexpected(logs.error());
  std::vector<Row> rows;
  for (const TankLog& log : *logs) {
    if (const auto added = add_rows(log, rows); !added) return tl::unexpected(added.error());
  }
  return rows;
}

}  // namespace pingvox::bench
