#include "merge.hpp"

#include <fmt/core.h>

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "bench/paired_timing.hpp"
#include "pingvox/analysis/resample.hpp"
#include "pingvox/geometry/random.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/sim/vehicle.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.04, kMergeTime_s = 120.0;
constexpr int kRuns = 3;

struct Move {
  std::string_view name;
  Pose to_from_map;
  double cell_m;
};

Result<OccupancyMap> harbour_map() {
  const Scene scene = harbour_scene({});
  SonarOptions sonar;
  sonar.bin_length_m = scene.sonar_range_m / static_cast<double>(sonar.bins);
  const Trajectory path = follow_route(scene.loop, kMergeTime_s, {});
  SonarSimulator beams(scene.world, path, sonar, static_cast<std::size_t>(kMergeTime_s * sonar.beams_per_s));
  OccupancyMap map(MapOptions{.resolution_m = kCell_m});
  if (const auto built = build_map(beams, path, {}, map); !built) return tl::unexpected(built.error());
  return map;
}

/// Places in the box of a map.
std::vector<Eigen::Vector3d> random_places(const OccupancyMap& map) {
  constexpr std::size_t kPlaces = 100'000;
  const Box box = *map.bounds();
  Random random(21);
  std::vector<Eigen::Vector3d> places;
  while (places.size() < kPlaces) {
    const Eigen::Array3d share(random.uniform(), random.uniform(), random.uniform());
    places.emplace_back(box.min.array() + share * (box.max - box.min).array());
  }
  return places;
}

/// Nothing may be free that was not, and no wall may be lost.
Result<void> check_sum(const OccupancyMap& map, const Move& move, const OccupancyMap& sum) {
  std::size_t walls = 0;
  for (const Eigen::Vector3d& place : random_places(map)) {
    const Eigen::Vector3d moved = move.to_from_map * place;
    const Occupancy before = map.classify(place), after = sum.classify(moved);
    if (after == Occupancy::kFree && before != Occupancy::kFree) {
      return fail(Error::Code::kCorrupt, fmt::format("{}: a place is free that was not", move.name));
    }
    if (before != Occupancy::kOccupied) continue;
    ++walls;
    bool is_found = false;
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3d beside = moved + move.cell_m * Eigen::Vector3d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      is_found = is_found || sum.classify(beside) == Occupancy::kOccupied;
    }
    if (!is_found) return fail(Error::Code::kCorrupt, fmt::format("{}: a wall is lost", move.name));
  }
  if (walls == 0) return fail(Error::Code::kCorrupt, "the map has no walls");
  return {};
}

}  // namespace

Result<std::vector<Row>> merge(const BenchOptions&) {
  const Result<OccupancyMap> map = harbour_map();
  if (!map) return tl::unexpected(map.error());
  const MapCounts counts = map->counts();
  const std::array moves = {Move{"merge-same", Pose::Identity(), kCell_m},
                            Move{"merge-moved", pose_from_rpy({1.0, 2.0, 0.3}, 0.0, 0.0, 0.5), kCell_m},
                            Move{"merge-coarse", pose_from_rpy({1.0, 2.0, 0.3}, 0.02, 0.01, 0.5), 2.5 * kCell_m}};
  std::vector<Row> rows;
  for (const Move& move : moves) {
    MapOptions options = map->options();
    options.resolution_m = move.cell_m;
    std::vector<double> times_s;
    for (int run = 0; run < kRuns; ++run) {
      OccupancyMap sum(options);
      const double started_s = cpu_time_s();
      const auto added = add_map(*map, move.to_from_map, sum);
      times_s.push_back(cpu_time_s() - started_s);
      if (!added) return tl::unexpected(added.error());
      if (run > 0) continue;
      if (const auto checked = check_sum(*map, move, sum); !checked) return tl::unexpected(checked.error());
    }
    Row row;
    row.add("name", move.name)
        .add_truth("checked", true)
        .add("cells", std::uint64_t{counts.occupied_cells + counts.free_cells})
        .add("leaves", std::uint64_t{counts.leaves})
        .add("cell_m", move.cell_m)
        .add("add_s", median(times_s));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace pingvox::bench
