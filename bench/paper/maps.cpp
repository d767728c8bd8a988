#include "maps.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "bench/drives/drive.hpp"
#include "bench/paired_timing.hpp"
#include "dense_grid.hpp"
#include "geometry/internal/ray_dda.hpp"
#include "line_map.hpp"
#include "mapping/internal/beam_tracer.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/slam/localizer.hpp"
#include "pingvox/viewer/render_map.hpp"
#include "pingvox/viewer/side_by_side.hpp"
#include "placed_sweep.hpp"
#include "tank_logs.hpp"

namespace pingvox::bench {
namespace {

using Eigen::Vector2d;

constexpr double kTolerance_m = 0.05;  ///< of a line from a wall

/// One drive makes the map, another one is followed in it.
struct Run {
  std::vector<PlacedSweep> mapped;
  Drive followed;
};

/// What is known of a place apart from the sonar.
struct Truth {
  std::vector<Vector2d> walls_m, round_m;  ///< points of straight and of other surfaces that the beams of the map saw
  /// Whether there is a surface within kTolerance_m of a point along a normal; nullopt: not known.
  std::function<std::optional<bool>(const Vector2d& point_m, const Vector2d& normal)> is_surface;
};

struct Place {
  std::string name;
  double cell_m = 0.05;
  std::vector<Run> runs;
  std::vector<Truth> truths;  ///< of each run
};

Eigen::Vector3d in_space(const Vector2d& point) {
  return {point.x(), point.y(), 0.0};
}

Truth truth_of(const Scene& scene, std::size_t walls, std::span<const PlacedSweep> sweeps) {
  // Each cell once, however often it was seen.
  std::map<std::pair<long, long>, std::pair<Vector2d, std::size_t>> seen;
  for (const PlacedSweep& sweep : sweeps) {
    for (const PlacedBeam& beam : sweep) {
      const Eigen::Vector3d from = beam.at(0.0);
      const auto first = scene.world.first({from, beam.at(1.0) - from}, scene.sonar_range_m);
      if (!first || first->range_m < EchoOptions::kDefaultBlanking_m) continue;
      const Vector2d point = beam.at(first->range_m).head<2>();
      seen.try_emplace({std::lround(point.x() / scene.cell_m), std::lround(point.y() / scene.cell_m)}, point,
                       first->surface);
    }
  }
  Truth truth;
  for (const auto& [cell, crossing] : seen) {
    (crossing.second < walls ? truth.walls_m : truth.round_m).push_back(crossing.first);
  }
  truth.is_surface = [&world = scene.world](const Vector2d& point_m, const Vector2d& normal) {
    const SoundRay through{in_space(point_m - kTolerance_m * normal), in_space(normal)};
    return std::optional(world.first(through, 2.0 * kTolerance_m).has_value());
  };
  return truth;
}

/// The recorded tank, whose sonar stands still at the origin.
Truth truth_of(const TankLog& log) {
  Truth truth;
  for (int degrees = 0; degrees < 360; ++degrees) {
    const double bearing_rad = degrees * kDegree_rad;
    const auto wall_m = log.wall_m(bearing_rad);
    if (wall_m) truth.walls_m.emplace_back(*wall_m * Vector2d(std::cos(bearing_rad), std::sin(bearing_rad)));
  }
  truth.is_surface = [wall_of = log.wall_m](const Vector2d& point_m, const Vector2d&) -> std::optional<bool> {
    const auto wall_m = wall_of(std::atan2(point_m.y(), point_m.x()));
    if (!wall_m) return std::nullopt;
    return std::abs(point_m.norm() - *wall_m) <= kTolerance_m;
  };
  return truth;
}

double distance_m(const WallLine& line, const Vector2d& point_m) {
  const Vector2d along = line.to_m - line.from_m;
  const double share = std::clamp(along.dot(point_m - line.from_m) / along.squaredNorm(), 0.0, 1.0);
  return (line.from_m + share * along - point_m).norm();
}

/// Share of points that have a line near them.
double recall(const LineMap& map, const std::vector<Vector2d>& points_m) {
  const auto found = std::ranges::count_if(points_m, [&](const Vector2d& point) {
    return std::ranges::any_of(map.lines, [&](const WallLine& l) { return distance_m(l, point) <= kTolerance_m; });
  });
  return static_cast<double>(found) / static_cast<double>(points_m.size());
}

/// Share of the lines' length that is on a surface.
double precision(const LineMap& map, const Truth& truth) {
  constexpr double kStep_m = 0.01;
  std::size_t right = 0, judged = 0;
  for (const WallLine& line : map.lines) {
    const Vector2d along = line.to_m - line.from_m, normal = Vector2d(-along.y(), along.x()).normalized();
    const auto steps = static_cast<int>(std::ceil(along.norm() / kStep_m));
    for (int i = 0; i < steps; ++i) {
      const auto is_right = truth.is_surface(line.from_m + (i + 0.5) / steps * along, normal);
      judged += is_right.has_value() ? 1 : 0;
      right += is_right.value_or(false) ? 1 : 0;
    }
  }
  return static_cast<double>(right) / static_cast<double>(judged);
}

/// What a map takes.
struct Built {
  std::uint64_t parts = 0, bytes = 0;
  double build_s = 0.0;
  std::uint64_t octomap_bytes = 0;  ///< of liboctomap's tree with the same nodes; 0: none
};

/// The quickest of some times.
double time_of(const std::function<void()>& work) {
  double least_s = std::numeric_limits<double>::max();
  for (int i = 0; i < 5; ++i) {
    const double before_s = cpu_time_s();
    work();
    least_s = std::min(least_s, cpu_time_s() - before_s);
  }
  return least_s;
}

OccupancyMap map_of(std::span<const PlacedSweep> sweeps, BeamShape shape, double cell_m) {
  OccupancyMap map({.resolution_m = cell_m});
  BeamTracer tracer({.shape = shape});
  for (const PlacedSweep& sweep : sweeps) {
    ScanUpdate scan(map.lattice());
    for (const PlacedBeam& beam : sweep) tracer.trace(beam.map_from_sonar, beam.beam, beam.echo, scan);
    map.apply(scan);
  }
  return map;
}

Built octree(const OccupancyMap& map, const Run& run, BeamShape shape) {
  const double build_s = time_of([&] { map_of(run.mapped, shape, map.lattice().resolution_m()); });
  // A node has a pointer and a float, and an inner one eight pointers: what liboctomap says itself, see paper_bytes.
  const MapCounts counts = map.counts();
  return {counts.nodes(), map.memory_bytes(), build_s, counts.nodes() * 16 + counts.inner * 64};
}

/// @return kCorrupt when its cells are not those of the octree
Result<Built> dense_grid(const Run& run, const OccupancyMap& octree) {
  const Lattice& lattice = octree.lattice();
  const Box box = *octree.bounds();
  const auto make = [&] {
    DenseGrid grid(lattice, box);
    for (const PlacedSweep& sweep : run.mapped) grid.add(sweep);
    return grid;
  };
  const DenseGrid grid = make();
  const MapCounts counts = octree.counts();
  bool is_same = grid.known() == counts.occupied_cells + counts.free_cells + counts.undecided_cells;
  for_each_leaf(octree, {}, [&](const Leaf& leaf) {
    // No cell of a layer is joined with others: those above and below it are unknown.
    is_same = is_same && grid.at({static_cast<std::uint16_t>(leaf.key.x), static_cast<std::uint16_t>(leaf.key.y),
                                  static_cast<std::uint16_t>(leaf.key.z)}) == std::optional(leaf.belief);
  });
  if (!is_same) return fail(Error::Code::kCorrupt, "the dense grid's cells are not those of the octree");
  return Built{grid.size(), grid.memory_bytes(), time_of(make)};
}

/// Lines as cells; the rest of their bounding box is free.
OccupancyMap draw(const LineMap& lines, double cell_m) {
  OccupancyMap map({.resolution_m = cell_m});
  ScanUpdate scan(map.lattice(), map.options().clamp.lowest);
  Eigen::AlignedBox2d box;
  for (const WallLine& line : lines.lines) box.extend(line.from_m).extend(line.to_m);
  for (double y = box.min().y(); y < box.max().y(); y += cell_m) {
    for (double x = box.min().x(); x < box.max().x(); x += cell_m) scan.add_miss(*map.lattice().key_of({x, y, 0.0}));
  }
  const auto add = [&](const Key& key) { scan.add_hit(key, map.options().clamp.highest); };
  for (const WallLine& line : lines.lines) {
    const Eigen::Vector3d from = in_space(line.from_m), to = in_space(line.to_m);
    std::ranges::for_each(*dda<std::uint16_t>(map.lattice(), from, to), add);
    add(*map.lattice().key_of(to));
  }
  map.apply(scan);
  return map;
}

/// All cells of the box around a map.
Built high_grid(const OccupancyMap& map) {
  const Box box = *map.bounds();
  const Eigen::Vector3d cells = (box.max - box.min) * map.lattice().cells_per_m();
  const auto count = static_cast<std::uint64_t>(std::llround(cells.prod()));
  return {count, count * sizeof(float)};
}

/// How far a vehicle was from where it was said to be, and how long that took; sums over runs.
struct Followed {
  std::size_t poses = 0, hypotheses = 0;  ///< after the first turn, when the vehicle may begin anywhere
  double m2 = 0.0, rad2 = 0.0, took_s = 0.0, recorded_s = 0.0;
};

/// @param followed  nullptr: not made, so nothing was followed in it
Row row_of_map(std::string_view place, std::string_view structure, const std::vector<Built>& runs,
               const Followed* followed) {
  Built sum;
  for (const Built& run : runs) {
    sum.parts += run.parts;
    sum.bytes += run.bytes;
    sum.build_s += run.build_s;
    sum.octomap_bytes += run.octomap_bytes;
  }
  Row row;
  row.add("name", "maps").add("place", place).add("structure", structure);
  row.add("parts", sum.parts / runs.size()).add("bytes", sum.bytes / runs.size());
  row.add_value("octomap_bytes", sum.octomap_bytes == 0 ? Value{} : Value(sum.octomap_bytes / runs.size()));
  if (followed == nullptr) {
    for (const char* name : {"build_ms", "rmse_m", "yaw_rmse_deg", "share_of_core", "hypotheses", "checked"}) {
      row.add_nothing(name);
    }
  } else {
    const auto poses = static_cast<double>(followed->poses);
    row.add("build_ms", 1e3 * sum.build_s / static_cast<double>(runs.size()))
        .add("rmse_m", std::sqrt(followed->m2 / poses))
        .add("yaw_rmse_deg", std::sqrt(followed->rad2 / poses) / kDegree_rad)
        .add("share_of_core", followed->took_s / followed->recorded_s)
        .add("hypotheses", static_cast<double>(followed->hypotheses) / static_cast<double>(runs.size()))
        .add_truth("checked", true);
  }
  return row;
}

/// Follows a vehicle whose motion is known, so that only the map makes a difference: twice, from where it begins, and
/// from anywhere until it is found.
Result<void> follow(const OccupancyMap& cells, const Run& run, Followed& sums) {
  Result<DistanceField> field = DistanceField::make(cells, {});
  if (!field) return tl::unexpected(field.error());
  const Drive& drive = run.followed;
  const double begin_s = drive.beams.front().time_s;
  Localizer anywhere(*field, {});
  const double before_s = cpu_time_s();
  Localizer localizer(*std::move(field), {});
  const Pose start = *drive.reference.at(begin_s);
  localizer.start(start.translation().x(), start.translation().y(), yaw_of(start), 0.1, 2.0 * kDegree_rad);
  for (const Beam& beam : drive.beams) {
    const Pose truth = *drive.reference.at(beam.time_s);
    localizer.add({beam.time_s, truth});
    if (const auto added = localizer.add(beam); !added) return tl::unexpected(added.error());
    const Pose error = truth.inverse() * localizer.pose()->map_from_body;
    ++sums.poses;
    sums.m2 += error.translation().head<2>().squaredNorm();
    sums.rad2 += std::pow(yaw_of(error), 2);
  }
  sums.took_s += cpu_time_s() - before_s;
  sums.recorded_s += drive.beams.back().time_s - begin_s;
  for (const Beam& beam : drive.beams) {
    anywhere.add({beam.time_s, *drive.reference.at(beam.time_s)});
    if (const auto added = anywhere.add(beam); !added) return tl::unexpected(added.error());
    if (anywhere.pose()) break;
  }
  sums.hypotheses += anywhere.hypotheses().size();
  return {};
}

/// Each drive is followed in the map of the one before.
Result<Place> simulated(std::string name, const Scene& scene, std::size_t walls) {
  constexpr std::uint64_t kRuns = 3;
  Place place{.name = std::move(name), .cell_m = scene.cell_m, .runs = {}, .truths = {}};
  std::vector<PlacedSweep> mapped;
  for (std::uint64_t seed = 1; seed <= kRuns + 1; ++seed) {
    Result<Drive> drive = simulate_drive(scene, Motion::kLoop, std::nullopt, seed);
    if (!drive) return tl::unexpected(drive.error());
    std::vector<PlacedSweep> sweeps = place_sweeps(drive->beams, drive->reference);
    if (seed > 1) {
      place.truths.push_back(truth_of(scene, walls, mapped));
      place.runs.push_back({std::move(mapped), *std::move(drive)});
    }
    mapped = std::move(sweeps);
  }
  return place;
}

/// Every other sweep makes the map, the rest is followed in it.
Result<std::optional<Place>> recorded() {
  const auto log = recorded_tank();
  if (!log) return tl::unexpected(log.error());
  if (!*log) return std::nullopt;
  std::vector<Beam> parts[2];
  for (std::size_t n = 0; n < (*log)->sweeps.size(); ++n) {
    const std::vector<Beam>& beams = (*log)->sweeps[n].beams;
    parts[n % 2].insert(parts[n % 2].end(), beams.begin(), beams.end());
  }
  const Result<NavLog> none = NavLog::make({}, NavClock::kUnknown);
  if (!none) return tl::unexpected(none.error());
  const Trajectory still = Trajectory::still(Pose::Identity());
  Place place{.name = "tank, recorded", .cell_m = 0.05, .runs = {}, .truths = {}};
  place.runs.push_back({place_sweeps(parts[0], still), Drive{std::move(parts[1]), *none, Pose::Identity(), still}});
  place.truths.push_back(truth_of(**log));
  return place;
}

Result<void> add_rows(const Place& place, std::vector<Row>& rows, std::vector<Row>& line_rows) {
  std::vector<Built> grids, high_grids, line_maps, ray_maps, cone_maps;
  Followed in_lines, in_rays, in_cones;
  std::size_t line_count = 0, corner_count = 0;
  double right = 0.0, walls = 0.0, round = 0.0;
  const auto count = static_cast<double>(place.runs.size());
  for (std::size_t n = 0; n < place.runs.size(); ++n) {
    const Run& run = place.runs[n];
    const OccupancyMap by_rays = map_of(run.mapped, BeamShape::kRay, place.cell_m),
                       by_cones = map_of(run.mapped, BeamShape::kCone, place.cell_m);
    const auto points = echoes_in_plane(run.mapped);
    const LineMap features = extract_lines(points, {});
    const Result<Built> dense = dense_grid(run, by_rays);
    if (!dense) return tl::unexpected(dense.error());
    if (const auto done = follow(draw(features, place.cell_m), run, in_lines); !done) return done;
    if (const auto done = follow(by_rays, run, in_rays); !done) return done;
    if (const auto done = follow(by_cones, run, in_cones); !done) return done;
    grids.push_back(*dense);
    high_grids.push_back(high_grid(by_cones));
    line_maps.push_back({features.lines.size() + features.corners.size(), features.memory_bytes(),
                         time_of([&] { extract_lines(points, {}); })});
    ray_maps.push_back(octree(by_rays, run, BeamShape::kRay));
    cone_maps.push_back(octree(by_cones, run, BeamShape::kCone));
    line_count += features.lines.size();
    corner_count += features.corners.size();
    right += precision(features, place.truths[n]) / count;
    walls += recall(features, place.truths[n].walls_m) / count;
    round += recall(features, place.truths[n].round_m) / count;
  }
  // The grid has the cells of the octree, so that the vehicle is found at the same places.
  rows.push_back(row_of_map(place.name, "grid, one layer", grids, &in_rays));
  rows.push_back(row_of_map(place.name, "lines and corners", line_maps, &in_lines));
  rows.push_back(row_of_map(place.name, "octree, one layer", ray_maps, &in_rays));
  rows.push_back(row_of_map(place.name, "grid, as high as the cones", high_grids, nullptr));
  rows.push_back(row_of_map(place.name, "octree, cones", cone_maps, &in_cones));
  Row row;
  row.add("name", "maps-lines")
      .add("place", place.name)
      .add("lines", static_cast<double>(line_count) / count)
      .add("corners", static_cast<double>(corner_count) / count)
      .add("tolerance_m", kTolerance_m)
      .add("precision", right)
      .add("recall_walls", walls)
      .add("recall_round", round)
      .add_truth("checked", true);
  line_rows.push_back(row);
  return {};
}

}  // namespace

Result<std::vector<Row>> paper_maps(const BenchOptions&) {
  std::vector<Row> rows, line_rows;
  const Scene tank = tank_scene({}), harbour = harbour_scene({});
  const Result<Place> in_tank = simulated("tank", tank, 4);
  if (!in_tank) return tl::unexpected(in_tank.error());
  if (const auto added = add_rows(*in_tank, rows, line_rows); !added) return tl::unexpected(added.error());
  const Result<Place> in_harbour = simulated("harbour", harbour, 3);
  if (!in_harbour) return tl::unexpected(in_harbour.error());
  if (const auto added = add_rows(*in_harbour, rows, line_rows); !added) return tl::unexpected(added.error());
  const auto real = recorded();
  if (!real) return tl::unexpected(real.error());
  if (*real) {
    if (const auto added = add_rows(**real, rows, line_rows); !added) return tl::unexpected(added.error());
  }
  rows.insert(rows.end(), line_rows.begin(), line_rows.end());
  return rows;
}

Result<Picture> harbour_and_its_lines() {
  const Scene harbour = harbour_scene({});
  const Result<Drive> drive = simulate_drive(harbour, Motion::kLoop, std::nullopt, 1);
  if (!drive) return tl::unexpected(drive.error());
  const auto sweeps = place_sweeps(drive->beams, drive->reference);
  const OccupancyMap map = map_of(sweeps, BeamShape::kRay, harbour.cell_m);
  const OccupancyMap lines = draw(extract_lines(echoes_in_plane(sweeps), {}), harbour.cell_m);
  const MapPictureOptions options{.target_px = 480, .at_least = map.bounds()};
  return side_by_side(std::vector<Panel>{{render_map(map, options), "octree of one layer"},
                                         {render_map(lines, options), "lines and corners of the same sweeps"}});
}

}  // namespace pingvox::bench
