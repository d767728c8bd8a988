#include "accuracy/ground_truth.hpp"

#include <utility>

#include "app/world_map.hpp"
#include "pingvox/analysis/slice.hpp"
#include "pingvox/analysis/visible_cells.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/polar_image.hpp"

namespace pingvox::bench {
namespace {

/// The layer of cells in which the head turns, or all of a map.
Result<OccupancyMap> part_of(const OccupancyMap& map, Extent extent) {
  if (extent == Extent::kSpace) return map;
  return map_of_slice(map, {.min_z_m = 0.0, .max_z_m = 0.0});
}

}  // namespace

Result<GroundTruth> GroundTruth::make(const Recording& recording, Extent extent, double resolution_m,
                                      double min_range_m) {
  std::vector<Pose> map_from_sensor;
  for (const SonarSimulator::Ping& ping : recording.pings) map_from_sensor.push_back(ping.map_from_sensor);
  return make(recording.scene, map_from_sensor,
              {.min_range_m = min_range_m,
               .max_range_m = recording.sonar.range_m(),
               .height_rad = recording.sonar.beam_height_rad},
              extent, resolution_m);
}

Result<GroundTruth> GroundTruth::make(const Scene& scene, std::span<const Pose> map_from_sensor,
                                      const ViewOptions& view, Extent extent, double resolution_m) {
  Eigen::AlignedBox3d water = scene.water_m;
  if (extent == Extent::kPlane) {
    water.min().z() = -2.0 * resolution_m;
    water.max().z() = 2.0 * resolution_m;
  }
  const Eigen::Vector3d inside_m = map_from_sensor.front().translation();
  const Result<OccupancyMap> world = app::world_map(scene.world, water, inside_m, resolution_m);
  if (!world) return tl::unexpected(world.error());
  Result<OccupancyMap> truth = part_of(*world, extent);
  if (!truth) return tl::unexpected(truth.error());
  Result<OccupancyMap> visible = visible_cells(*truth, *world, map_from_sensor, view);
  if (!visible) return tl::unexpected(visible.error());
  return GroundTruth(extent, *std::move(truth), *std::move(visible));
}

Result<MapAgreement> GroundTruth::score(const OccupancyMap& map, const Thresholds& thresholds,
                                        std::uint32_t near_cells) const {
  const Result<OccupancyMap> part = part_of(map, extent_);
  if (!part) return tl::unexpected(part.error());
  return agreement_of(with_thresholds(*part, thresholds), truth_, {judged_box(truth_), &visible_, near_cells});
}

Echoes detect(const Recording& recording, const FilterOptions& filter, const EchoOptions& options) {
  Echoes all;
  for (const Sweep& sweep : recording.sweeps) {
    const Echoes echoes = detect_echoes(apply_filter(PolarImage(sweep), filter), sweep, options);
    all.insert(all.end(), echoes.begin(), echoes.end());
  }
  return all;
}

Echoes at_first_bins(Echoes echoes, double bin_length_m) {
  for (std::optional<Echo>& echo : echoes) {
    if (echo) echo->range_m = (static_cast<double>(echo->first) + 0.5) * bin_length_m;
  }
  return echoes;
}

Echoes true_echoes(const Recording& recording, const std::vector<TrueReturns>& truths, double min_range_m) {
  Echoes echoes;
  for (const TrueReturns& truth : truths) {
    if (!truth.axis_m || *truth.axis_m < min_range_m) {
      echoes.emplace_back();
      continue;
    }
    const auto bin = static_cast<std::size_t>(*truth.axis_m / recording.sonar.bin_length_m);
    echoes.emplace_back(Echo{.first = bin, .peak = bin, .last = bin, .range_m = *truth.axis_m, .intensity = 160});
  }
  return echoes;
}

Result<OccupancyMap> map_echoes(const Recording& recording, const Echoes& echoes, const BeamModelOptions& model,
                                double resolution_m) {
  OccupancyMap map(MapOptions{.resolution_m = resolution_m});
  ScanUpdate scan(map.lattice());
  std::size_t n = 0;
  for (const Sweep& sweep : recording.sweeps) {
    for (const Beam& beam : sweep.beams) {
      trace_beam(recording.pings[n].map_from_sensor, beam, echoes[n], model, scan);
      ++n;
    }
    if (const auto applied = map.apply(scan); !applied) return tl::unexpected(applied.error());
    scan.clear();
  }
  return map;
}

}  // namespace pingvox::bench
