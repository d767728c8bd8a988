#include "mapping/bundle_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "map/kernels/ray_ends.hpp"

namespace pingvox {
namespace {

/// Angles from -width / 2 to width / 2, both included, at most `apart` from each other; 0 alone when there is no width.
std::vector<double> spread(double width_rad, double apart_rad) {
  if (width_rad <= 0.0) return {0.0};
  const auto gaps = static_cast<std::size_t>(std::max(1.0, std::ceil(width_rad / apart_rad)));
  std::vector<double> angles(gaps + 1);
  for (std::size_t i = 0; i <= gaps; ++i) {
    angles[i] = width_rad * (static_cast<double>(i) / static_cast<double>(gaps) - 0.5);
  }
  return angles;
}

/// The vertical beam pattern: 1 on the axis, half at the edge.
double pattern(double elevation_rad, double height_rad) {
  const double off_axis = height_rad > 0.0 ? std::clamp(2.0 * elevation_rad / height_rad, -1.0, 1.0) : 0.0;
  return std::exp2(-off_axis * off_axis);
}

/// What evidence is divided by that may come from so many cells.
double thinned_by(double cells_on_arc) {
  return std::pow(std::max(1.0, cells_on_arc), 0.25);
}

}  // namespace

double share_on_arc(double elevation_rad, double height_rad, double cells_on_arc) {
  return pattern(elevation_rad, height_rad) / thinned_by(cells_on_arc);
}

std::vector<BundleRay> beam_bundle(const BeamModelOptions& options, double bearing_rad, double range_m,
                                   double resolution_m) {
  const detail::BundleGrid grid = detail::bundle_grid(options, bearing_rad, range_m, resolution_m);
  std::vector<BundleRay> bundle;
  bundle.reserve(grid.azimuths.size() * grid.shares.size());
  for (std::size_t i = 0; i < grid.shares.size(); ++i) {
    for (const auto& azimuth : grid.azimuths) bundle.push_back({grid.direction(i, azimuth), grid.shares[i]});
  }
  return bundle;
}

namespace detail {

double width_of(const BeamModelOptions& options) {
  return options.shape == BeamShape::kRay ? 0.0 : options.width_rad;
}

double height_of(const BeamModelOptions& options) {
  return options.shape == BeamShape::kCone ? options.height_rad : 0.0;
}

BundleGrid bundle_grid(const BeamModelOptions& options, double bearing_rad, double range_m, double resolution_m) {
  const double width = width_of(options), height = height_of(options);
  const double apart_rad = resolution_m / (std::numbers::sqrt2 * std::max(range_m, resolution_m));
  const double thinned = thinned_by(std::max(width, height) * range_m / resolution_m);

  BundleGrid grid;
  for (const double azimuth : spread(width, apart_rad)) {
    grid.azimuths.push_back({std::cos(bearing_rad + azimuth), std::sin(bearing_rad + azimuth)});
  }
  const std::vector<double> elevations = spread(height, apart_rad);
  const std::size_t count = elevations.size();
  grid.across.resize(count + kEndsAtOnce);
  grid.up.resize(count + kEndsAtOnce);
  grid.shares.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double elevation = elevations[i];
    grid.across[i] = std::cos(elevation);
    grid.up[i] = std::sin(elevation);
    grid.shares[i] = pattern(elevation, height) / thinned;
  }
  return grid;
}

}  // namespace detail
}  // namespace pingvox
