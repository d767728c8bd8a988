#include "pingvox/mapping/beam_tracer.hpp"

#include <algorithm>
#include <cassert>

#include "mapping/add_hits.hpp"
#include "mapping/bundle_grid.hpp"
#include "pingvox/mapping/insonified_volume.hpp"

namespace pingvox {
namespace {

/// The part of the beam within which silence means that nothing is there.
BeamModelOptions free_part(BeamModelOptions options) {
  options.width_rad *= options.free_share;
  options.height_rad *= options.free_share;
  return options;
}

/// @return how many rays were left out because an end of them lies outside of the lattice
std::size_t add_misses(const Pose& map_from_sensor, double bearing_rad, double range_m, const BeamModelOptions& options,
                       ScanUpdate& scan) {
  if (options.shape != BeamShape::kRay && options.tracing == Tracing::kGeometry) {
    const InsonifiedVolume volume{map_from_sensor, bearing_rad, detail::width_of(options), detail::height_of(options),
                                  range_m};
    if (trace_volume(volume, scan)) return 0;
    // Near the border of the lattice single rays can still be told from those that leave it.
  }
  std::size_t outside = 0;
  const Eigen::Vector3d origin_m = map_from_sensor.translation();
  for (const BundleRay& ray : beam_bundle(options, bearing_rad, range_m, scan.lattice().resolution_m())) {
    const Eigen::Vector3d end_m = map_from_sensor * (ray.direction * range_m);
    outside += !trace_ray(origin_m, end_m, options.ray, scan);
  }
  return outside;
}

}  // namespace

BeamTracer::BeamTracer(const BeamModelOptions& options, double max_range_m)
    : options_(options),
      max_range_m_(max_range_m),
      elevations_(std::make_unique<detail::ElevationTables>(detail::height_of(options))) {
  assert(options.validate() && max_range_m > 0.0);
}
BeamTracer::BeamTracer(BeamTracer&&) noexcept = default;
BeamTracer& BeamTracer::operator=(BeamTracer&&) noexcept = default;
BeamTracer::~BeamTracer() = default;

std::size_t BeamTracer::trace(const Pose& map_from_sensor, const Beam& beam, const std::optional<Echo>& echo,
                              ScanUpdate& scan) {
  if (!echo && options_.silent == Silent::kNothing) return 0;
  const double heard_m = echo ? echo->range_m : static_cast<double>(beam.intensities.size()) * beam.bin_length_m;
  const bool is_hit = echo && heard_m <= max_range_m_;
  // Sound came back from the echo's first bin on: only what lies before is sure to have been passed.
  const double passed_m = echo ? std::min(heard_m, static_cast<double>(echo->first) * beam.bin_length_m) : heard_m;
  const double free_m = std::min(passed_m, max_range_m_);
  std::size_t outside = 0;
  if (free_m > 0.0) outside = add_misses(map_from_sensor, beam.bearing_rad, free_m, free_part(options_), scan);
  if (!is_hit || !(heard_m > 0.0)) return outside;

  const LogOdds evidence =
      options_.hit_from == HitFrom::kIntensity ? evidence_of_intensity(echo->intensity, options_.hit) : options_.hit;
  const detail::BundleGrid rays =
      detail::bundle_grid(options_, beam.bearing_rad, heard_m, scan.lattice().resolution_m(), *elevations_);
  return std::max(outside, detail::add_hits(map_from_sensor, rays, heard_m, evidence, scan));
}

}  // namespace pingvox
