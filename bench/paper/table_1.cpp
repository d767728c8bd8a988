#include "table_1.hpp"

#include <fmt/core.h>

#include <array>
#include <memory>
#include <optional>

#include "bench/paired_timing.hpp"
#include "bench/speed/same_map.hpp"
#include "claim.hpp"
#include "cube.hpp"

namespace pingvox::bench {
namespace {

/// A column of the table, as printed.
struct Column {
  const char* name;
  Pruning pruning;
  std::uint64_t nodes, inner, leaves;
  double seconds;
};
constexpr std::array kColumns = {
    Column{"unpruned", Pruning::kNever, 1'145'977, 145'977, 1'000'000, 5.31},
    Column{"pruned", Pruning::kEachUpdate, 19'769, 5'201, 19'769, 13.8},
    Column{"lazy", Pruning::kLazy, 19'769, 5'201, 19'769, 2.9},
};

/// The cube in both libraries.
struct Both {
  std::optional<OccupancyMap> map;
  std::unique_ptr<octomap::OcTree> tree;
  void clear() {
    map.emplace(MapOptions{.resolution_m = PaperCube::kCell_m});
    tree = std::make_unique<octomap::OcTree>(PaperCube::kCell_m);
  }
};

/// Unpruned trees are compared cell by cell, not node by node.
bool is_same(const Both& both) {
  return difference(*both.map, *both.tree).differs == 0 && both.map->counts().nodes() == both.tree->size();
}

std::vector<Row> counts_of(const Column& column) {
  Both both;
  both.clear();
  const PaperCube cube;
  cube.fill(*both.map, column.pruning);
  cube.fill(*both.tree, column.pruning);
  const MapCounts ours = both.map->counts();
  const std::uint64_t peer_leaves = both.tree->getNumLeafNodes(), peer_nodes = both.tree->size();
  const bool same = is_same(both);
  const auto row = [&](const char* what, std::uint64_t paper, std::uint64_t own, std::uint64_t peer, const char* why) {
    return row_of({.name = fmt::format("table-1-{}-{}", what, column.name),
                   .section = "Table 1",
                   .unit = "nodes",
                   .paper = paper,
                   .ours = own,
                   .octomap = peer,
                   .holds = paper == own ? Holds::kYes : Holds::kNo,
                   .checked = same && own == peer,
                   .why = why});
  };
  return {row("nodes", column.nodes, ours.nodes(), peer_nodes, ""),
          row("inner", column.inner, ours.inner, peer_nodes - peer_leaves, ""),
          row("leaves", column.leaves, ours.leaves, peer_leaves,
              column.leaves == ours.leaves ? "" : "the paper's row repeats the count of all nodes")};
}

struct Times {
  double ours_s, octomap_s;
  bool same;  ///< both maps are equal
};

Times times_of(const Column& column, const PaperCube& cube, int pairs) {
  Both both;
  both.clear();
  const Side ours{[&] { both.map.emplace(MapOptions{.resolution_m = PaperCube::kCell_m}); },
                  [&] { cube.fill(*both.map, column.pruning); }};
  const Side peer{[&] { both.tree = std::make_unique<octomap::OcTree>(PaperCube::kCell_m); },
                  [&] { cube.fill(*both.tree, column.pruning); }};
  const PairedTimes result = time_in_pairs(ours, peer, {.pairs = pairs});
  return {result.ours_s, result.peer_s, is_same(both)};
}

/// Experiment: the paper has times for one only.
enum class Whose { kPapers, kOurs };

/// A row for each column, and the time of pruning at each update / at the end.
void add_times(const std::string& name, const PaperCube& cube, int pairs, Whose whose, const char* why,
               std::vector<Row>& rows) {
  std::array<Times, kColumns.size()> times{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    times[i] = times_of(kColumns[i], cube, pairs);
    rows.push_back(row_of({.name = fmt::format("table-1-{}-{}", name, kColumns[i].name),
                           .section = "Table 1",
                           .unit = "s",
                           .paper = whose == Whose::kPapers ? Value(kColumns[i].seconds) : Value(),
                           .ours = times[i].ours_s,
                           .octomap = times[i].octomap_s,
                           .checked = times[i].same,
                           .why = why}));
  }
  rows.push_back(row_of({.name = fmt::format("table-1-{}-pruned-to-lazy", name),
                         .section = "Table 1",
                         .unit = "times",
                         .paper = kColumns[1].seconds / kColumns[2].seconds,
                         .ours = times[1].ours_s / times[2].ours_s,
                         .octomap = times[1].octomap_s / times[2].octomap_s,
                         .holds = times[1].ours_s > times[2].ours_s ? Holds::kYes : Holds::kNo,
                         .checked = times[1].same && times[2].same,
                         .why = "ours goes up from a brick of 64 cells only when it leaves it"}));
}

}  // namespace

Result<std::vector<Row>> paper_table_1(const BenchOptions&) {
  std::vector<Row> rows;
  for (const Column& column : kColumns) {
    for (Row& row : counts_of(column)) rows.push_back(std::move(row));
  }
  add_times("time", {}, 5, Whose::kOurs, "one update for each of 10^6 cells", rows);
  add_times("time-8-updates", {.evidence = LogOdds(20.0F), .updates_along_axis = 2}, 1, Whose::kPapers,
            "as in the authors' published program: 8 updates for each cell", rows);
  return rows;
}

}  // namespace pingvox::bench
