#include "mapping/internal/beam_tracer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "mapping/add_hits.hpp"
#include "mapping/bundle_grid.hpp"
#include "mapping/internal/insonified_volume.hpp"

namespace pingvox {
namespace {

/// The part of the beam within which silence means that nothing is there.
BeamModelOptions free_part(BeamModelOptions options) {
  options.width_rad *= options.free_share;
  options.height_rad *= options.free_share;
  return options;
}

/// How far a beam says something.
struct Reach {
  double heard_m;  ///< the echo's range, or the end of the beam
  double free_m;   ///< up to here nothing sent sound back
  bool is_hit;
};

Reach reach_of(const PlacedBeam& beam, const BeamModelOptions& options, double max_range_m) {
  const double end_m = static_cast<double>(beam.bins) * beam.bin_length_m;
  if (!beam.echo) return {end_m, options.silent == Silent::kNothing ? 0.0 : std::min(end_m, max_range_m), false};
  const double heard_m = beam.echo->range_m;
  // Sound came back from the echo's first bin on: only what lies before is sure to have been passed.
  const double passed_m = std::min(heard_m, static_cast<double>(beam.echo->first) * beam.bin_length_m);
  return {heard_m, std::min(passed_m, max_range_m), heard_m > 0.0 && heard_m <= max_range_m};
}

LogOdds evidence_of(const Echo& echo, const BeamModelOptions& options) {
  return options.hit_from == HitFrom::kIntensity ? evidence_of_intensity(echo.intensity, options.hit) : options.hit;
}

/// @return how many rays were left out because an end of them lies outside of the lattice
std::size_t free_volume(const PlacedBeam& beam, double range_m, const BeamModelOptions& options, ScanUpdate& scan) {
  if (options.tracing == Tracing::kGeometry) {
    const InsonifiedVolume volume{beam.map_from_sensor, beam.bearing_rad, detail::width_of(options),
                                  detail::height_of(options), range_m};
    if (trace_volume(volume, scan)) return 0;
    // Near the border of the lattice single rays can still be told from those that leave it.
  }
  std::size_t outside = 0;
  for (const BundleRay& ray : beam_bundle(options, beam.bearing_rad, range_m, scan.lattice().resolution_m())) {
    const Eigen::Vector3d end_m = beam.map_from_sensor * (ray.direction * range_m);
    outside += !trace_ray(beam.map_from_sensor.translation(), end_m, options.ray, scan);
  }
  return outside;
}

}  // namespace

BeamTracer::BeamTracer(const BeamModelOptions& options, double max_range_m)
    : options_(options),
      max_range_m_(max_range_m),
      elevations_(std::make_unique<detail::ElevationTables>(detail::height_of(options))),
      rays_(options.ray) {
  assert(options.validate() && max_range_m > 0.0);
}
BeamTracer::BeamTracer(BeamTracer&&) noexcept = default;
BeamTracer& BeamTracer::operator=(BeamTracer&&) noexcept = default;
BeamTracer::~BeamTracer() = default;

std::vector<std::size_t> BeamTracer::trace(std::span<const PlacedBeam> beams, ScanUpdate& scan) {
  if (options_.shape == BeamShape::kRay) return trace_axes(beams, scan);
  std::vector<std::size_t> left_out(beams.size(), 0);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const PlacedBeam& beam = beams[i];
    const Reach reach = reach_of(beam, options_, max_range_m_);
    if (reach.free_m > 0.0) left_out[i] = free_volume(beam, reach.free_m, free_part(options_), scan);
    if (!reach.is_hit) continue;
    const detail::BundleGrid rays =
        detail::bundle_grid(options_, beam.bearing_rad, reach.heard_m, scan.lattice().resolution_m(), *elevations_);
    left_out[i] = std::max(left_out[i], detail::add_hits(beam.map_from_sensor, rays, reach.heard_m,
                                                         evidence_of(*beam.echo, options_), scan));
  }
  return left_out;
}

/// Beams as rays: all of them are walked together.
std::vector<std::size_t> BeamTracer::trace_axes(std::span<const PlacedBeam> beams, ScanUpdate& scan) {
  std::vector<std::size_t> left_out(beams.size(), 0), of_ray;
  std::vector<Eigen::Vector3d> from_m, to_m;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const PlacedBeam& beam = beams[i];
    const Reach reach = reach_of(beam, options_, max_range_m_);
    const Eigen::Vector3d axis(std::cos(beam.bearing_rad), std::sin(beam.bearing_rad), 0.0);
    if (reach.free_m > 0.0) {
      from_m.emplace_back(beam.map_from_sensor.translation());
      to_m.push_back(beam.map_from_sensor * (axis * reach.free_m));
      of_ray.push_back(i);
    }
    if (!reach.is_hit) continue;
    const auto end = scan.lattice().key_of<WideWord>(beam.map_from_sensor * (axis * reach.heard_m));
    if (end) scan.add_hit(*end, evidence_of(*beam.echo, options_));
    left_out[i] = !end;
  }
  for (const std::size_t ray : rays_.trace(from_m, to_m, scan)) left_out[of_ray[ray]] = 1;
  return left_out;
}

std::size_t BeamTracer::trace(const Pose& map_from_sensor, const Beam& beam, const std::optional<Echo>& echo,
                              ScanUpdate& scan) {
  const PlacedBeam placed{map_from_sensor, beam.bearing_rad, beam.bin_length_m, beam.intensities.size(), echo};
  return trace(std::span(&placed, 1), scan).front();
}

}  // namespace pingvox
