#include "drives/drive_maps.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <utility>

#include "pingvox/analysis/compare.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/mapping/rebuilt_map.hpp"

namespace pingvox::bench {
namespace {

double wall_time_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

BuildOptions build_options(BeamShape shape, const Pose& body_from_sonar) {
  BuildOptions build;
  build.model.shape = shape;
  build.body_from_sensor = body_from_sonar;
  return build;
}

Result<OccupancyMap> map_along(const Drive& drive, const Trajectory& trajectory, const BuildOptions& build,
                               double cell_m) {
  OccupancyMap map({.resolution_m = cell_m});
  BeamsInMemory beams(drive.beams);
  if (const auto built = build_map(beams, trajectory, build, map); !built) return tl::unexpected(built.error());
  return map;
}

double number(const std::optional<double>& share) {
  return share.value_or(std::numeric_limits<double>::quiet_NaN());
}

std::string_view name_of(BeamShape shape) {
  return shape == BeamShape::kRay ? "ray" : shape == BeamShape::kFan ? "fan" : "cone";
}

}  // namespace

Result<DriveMaps> DriveMaps::make(std::string_view world, const Scene& scene, const Drive& drive, std::uint64_t seed,
                                  double cell_m) {
  std::vector<Pose> map_from_sonar;
  for (const Beam& beam : drive.beams) {
    if (const auto pose = drive.reference.at(beam.time_s)) map_from_sonar.push_back(*pose * drive.body_from_sonar);
  }
  const ViewOptions view{.min_range_m = EchoOptions::kDefaultBlanking_m, .max_range_m = scene.sonar_range_m};
  Result<GroundTruth> truth = GroundTruth::make(scene, map_from_sonar, view, Extent::kPlane, cell_m);
  if (!truth) return tl::unexpected(truth.error());
  return DriveMaps(world, drive, seed, cell_m, *std::move(truth));
}

Result<std::vector<Row>> DriveMaps::judge(std::string_view method, const Trajectory& trajectory,
                                          const Pose& body_from_sonar) const {
  const Result<Pose> aligned = align(trajectory, drive_->reference);
  if (!aligned) return tl::unexpected(aligned.error());
  std::vector<Row> rows;
  for (const BeamShape shape : {BeamShape::kCone, BeamShape::kRay}) {
    const Result<OccupancyMap> map =
        map_along(*drive_, move_by(*aligned, trajectory), build_options(shape, body_from_sonar), cell_m_);
    if (!map) return tl::unexpected(map.error());
    const Thresholds& thresholds = map->options().thresholds;
    const Result<MapAgreement> near = truth_.score(*map, thresholds), two = truth_.score(*map, thresholds, 2);
    if (!near) return tl::unexpected(near.error());
    if (!two) return tl::unexpected(two.error());
    Row row;
    row.add("name", "slam-map")
        .add("drive", world_)
        .add("along", method)
        .add("seed", seed_)
        .add("beam", name_of(shape))
        .add("resolution_m", cell_m_)
        .add("occupied", near->occupied_a)
        .add("visible", near->to_find)
        .add("precision", number(near->precision()))
        .add("recall", number(near->recall()))
        .add("precision_2_cells", number(two->precision()))
        .add("recall_2_cells", number(two->recall()))
        .add("free_true", number(near->free_true()))
        .add("free_true_1_cell", number(near->free_true_near()));
    rows.push_back(std::move(row));
  }
  return rows;
}

Result<Row> rebuild_map(std::string_view world, const Drive& drive, BeamShape shape, double cell_m) {
  const BuildOptions build = build_options(shape, drive.body_from_sonar);
  Result<RebuiltMap> map = RebuiltMap::make(build, {.resolution_m = cell_m});
  if (!map) return tl::unexpected(map.error());
  const Trajectory along = move_by(pose_from_rpy({3.0, 0.0, 0.0}, 0.0, 0.0, 0.05), drive.reference);
  double longest_add_s = 0.0;
  for (const Beam& beam : drive.beams) {
    const double before_s = wall_time_s();
    if (const auto added = map->add(beam, along.at(beam.time_s)); !added) return tl::unexpected(added.error());
    longest_add_s = std::max(longest_add_s, wall_time_s() - before_s);
  }
  if (const auto finished = map->finish(); !finished) return tl::unexpected(finished.error());
  const double before_s = wall_time_s();
  if (const auto corrected = map->correct(drive.reference); !corrected) return tl::unexpected(corrected.error());
  const double corrected_s = wall_time_s();
  if (const auto waited = map->wait(); !waited) return tl::unexpected(waited.error());
  const double rebuilt_s = wall_time_s() - before_s;

  const Result<OccupancyMap> batch = map_along(drive, drive.reference, build, cell_m);
  if (!batch) return tl::unexpected(batch.error());
  const auto compared = compare_maps(map->map(), *batch, Sameness::kLogOdds);
  if (!compared) return tl::unexpected(compared.error());
  if (!compared->equal()) return fail(Error::Code::kCorrupt, "the rebuilt map is not that of all beams");
  Row row;
  row.add("name", "rebuilt-map")
      .add("drive", world)
      .add_truth("checked", true)
      .add("beam", name_of(shape))
      .add("resolution_m", cell_m)
      .add("beams", std::uint64_t{drive.beams.size()})
      .add("cells", compared->cells())
      .add("leaves", map->map().counts().leaves)
      .add("longest_add_s", longest_add_s)
      .add("correct_s", corrected_s - before_s)
      .add("rebuilt_s", rebuilt_s)
      .add("trace_s", map->report().seconds.trace)
      .add("apply_s", map->report().seconds.apply);
  return row;
}

}  // namespace pingvox::bench
