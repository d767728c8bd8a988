#include "accuracy/judged_world.hpp"

#include <utility>

#include "app/world_map.hpp"
#include "pingvox/map/scan_update.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/polar_image.hpp"

namespace pingvox::bench {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double kBehind_m = 3.0;  ///< of what is behind a wall

/// The world with what is behind its walls, as far as it has some.
AlignedBox3d box_to_judge(const Recording& recording) {
  const std::string_view world = recording.options.world;
  const bool has_bottom = world != "tank", has_lid = world == "cave", has_sides = world != "seabed";
  AlignedBox3d box = recording.scene.water_m;
  if (has_bottom) box.min().z() -= kBehind_m;
  if (has_lid) box.max().z() += kBehind_m;
  if (has_sides) {
    box.min().x() -= kBehind_m;
    box.max().x() += kBehind_m;
    box.max().y() += kBehind_m;
    if (!world.starts_with("harbour")) box.min().y() -= kBehind_m;
  }
  // A face of the box belongs to the upper cell, which lies outside of the world.
  constexpr double kHair_m = 1e-6;
  return {box.min() + Vector3d::Constant(kHair_m), box.max() - Vector3d::Constant(kHair_m)};
}

}  // namespace

Result<JudgedWorld> JudgedWorld::make(const Recording& recording, Extent extent, double resolution_m,
                                      const std::vector<Vector3d>& visible_m) {
  AlignedBox3d water = recording.scene.water_m;
  if (extent == Extent::kPlane) {
    water.min().z() = -2.0 * resolution_m;
    water.max().z() = 2.0 * resolution_m;
  }
  const Vector3d inside_m = recording.pings.front().map_from_sensor.translation();
  const Result<OccupancyMap> truth = app::world_map(recording.scene.world, water, inside_m, resolution_m);
  if (!truth) return tl::unexpected(truth.error());
  const AlignedBox3d judged_m = box_to_judge(recording);
  const CellBox box =
      extent == Extent::kPlane ? CellBox::layer(truth->lattice(), judged_m, 0.0) : CellBox(truth->lattice(), judged_m);
  return JudgedWorld(box, box.classes_of(*truth), box.mark(visible_m));
}

MapScore JudgedWorld::score(const OccupancyMap& map, const Thresholds& thresholds) const {
  return score_map(box_.classes_of(map, thresholds), truth_, visible_);
}

Echoes detect(const Recording& recording, const FilterOptions& filter, const EchoOptions& options) {
  Echoes all;
  for (const Sweep& sweep : recording.sweeps) {
    const Echoes echoes = detect_echoes(filtered(PolarImage(sweep), filter), sweep, options);
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
