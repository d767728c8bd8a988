#include "pingvox/mapping/beam_model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "mapping/add_hits.hpp"
#include "mapping/bundle_grid.hpp"
#include "pingvox/mapping/insonified_volume.hpp"

namespace pingvox {
namespace {

using detail::height_of;
using detail::width_of;

/// The part of the beam within which silence means that nothing is there.
BeamModelOptions passed_part(BeamModelOptions options) {
  options.width_rad *= options.free_share;
  options.height_rad *= options.free_share;
  return options;
}

/// @return how many rays were left out because an end of them lies outside of the lattice
std::size_t add_misses(const Lattice& lattice, const Pose& map_from_sensor, double bearing_rad, double range_m,
                       const BeamModelOptions& options, ScanUpdate& scan) {
  if (options.shape != BeamShape::kRay && options.tracing == Tracing::kGeometry) {
    const InsonifiedVolume volume{map_from_sensor, bearing_rad, width_of(options), height_of(options), range_m};
    if (trace_volume(lattice, volume, scan)) return 0;
    // Near the border of the lattice single rays can still be told from those that leave it.
  }
  std::size_t outside = 0;
  const Eigen::Vector3d origin_m = map_from_sensor.translation();
  for (const BundleRay& ray : beam_bundle(options, bearing_rad, range_m, lattice.resolution_m())) {
    const Eigen::Vector3d end_m = map_from_sensor * (ray.direction * range_m);
    outside += !trace_ray(lattice, origin_m, end_m, options.ray, scan);
  }
  return outside;
}

}  // namespace

Result<void> BeamModelOptions::validate() const {
  std::string bad;
  if (!(width_rad > 0.0 && width_rad <= std::numbers::pi)) {
    bad += fmt::format(" beam width must be in (0, 180] degrees, is {};", width_rad * 180.0 / std::numbers::pi);
  }
  if (!(height_rad > 0.0 && height_rad < std::numbers::pi)) {
    bad += fmt::format(" beam height must be in (0, 180) degrees, is {};", height_rad * 180.0 / std::numbers::pi);
  }
  if (!(free_share > 0.0 && free_share <= 1.0)) bad += fmt::format(" free share must be in (0, 1], is {};", free_share);
  if (!(hit > LogOdds(0.0F)) || !std::isfinite(hit.value())) {
    bad += fmt::format(" hit must be a probability in (0.5, 1), is {};", hit.probability());
  }
  if (!(miss < LogOdds(0.0F)) || !std::isfinite(miss.value())) {
    bad += fmt::format(" miss must be a probability in (0, 0.5), is {};", miss.probability());
  }
  if (!(max_range_m > 0.0)) bad += fmt::format(" max range must be > 0 m, is {};", max_range_m);
  if (bad.empty()) return {};
  bad.pop_back();
  return fail(Error::Code::kBadOption, "beam model:" + bad);
}

LogOdds evidence_of_intensity(std::uint8_t intensity, LogOdds hit) {
  return LogOdds(hit.value() * 0.5F * (1.0F + static_cast<float>(intensity) / 255.0F));
}

double cells_in_beam(const BeamModelOptions& options, double range_m, double resolution_m) {
  const double range = std::min(range_m, options.max_range_m) / resolution_m;
  const double width = std::max(1.0, width_of(options) * range), height = std::max(1.0, height_of(options) * range);
  return range * width * height / 3.0;
}

std::size_t trace_beam(const Lattice& lattice, const Pose& map_from_sensor, const Beam& beam,
                       const std::optional<Echo>& echo, const BeamModelOptions& options, ScanUpdate& scan) {
  if (!echo && options.silent == Silent::kNothing) return 0;
  const double heard_m = echo ? echo->range_m : static_cast<double>(beam.intensities.size()) * beam.bin_length_m;
  const bool is_hit = echo && heard_m <= options.max_range_m;
  // Sound came back from the echo's first bin on: only what lies before is sure to have been passed.
  const double passed_m = echo ? std::min(heard_m, static_cast<double>(echo->first) * beam.bin_length_m) : heard_m;
  const double free_m = std::min(passed_m, options.max_range_m);
  std::size_t outside = 0;
  if (free_m > 0.0)
    outside = add_misses(lattice, map_from_sensor, beam.bearing_rad, free_m, passed_part(options), scan);
  if (!is_hit || !(heard_m > 0.0)) return outside;

  const LogOdds evidence =
      options.hit_from == HitFrom::kIntensity ? evidence_of_intensity(echo->intensity, options.hit) : options.hit;
  const detail::BundleGrid rays = detail::bundle_grid(options, beam.bearing_rad, heard_m, lattice.resolution_m());
  return std::max(outside, detail::add_hits(lattice, map_from_sensor, rays, heard_m, evidence, scan));
}

}  // namespace pingvox
