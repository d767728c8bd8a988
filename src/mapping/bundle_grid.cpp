#include "mapping/bundle_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pingvox {
namespace {

/// Divisor of the evidence of an arc of so many cells.
double divisor_on_arc(double cells_on_arc) {
  return std::pow(std::max(1.0, cells_on_arc), 0.25);
}

}  // namespace

double share_on_arc(double elevation_rad, double height_rad, double cells_on_arc) {
  return detail::vertical_pattern(elevation_rad, height_rad) / divisor_on_arc(cells_on_arc);
}

std::vector<BundleRay> beam_bundle(const BeamModelOptions& options, double bearing_rad, double range_m,
                                   double resolution_m) {
  detail::ElevationTables tables(detail::height_of(options));
  const detail::BundleGrid grid = detail::bundle_grid(options, bearing_rad, range_m, resolution_m, tables);
  std::vector<BundleRay> bundle;
  bundle.reserve(grid.azimuths.size() * grid.elevations.count);
  for (std::size_t i = 0; i < grid.elevations.count; ++i) {
    for (const auto& azimuth : grid.azimuths) bundle.push_back({grid.direction(i, azimuth), grid.share(i)});
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

BundleGrid bundle_grid(const BeamModelOptions& options, double bearing_rad, double range_m, double resolution_m,
                       ElevationTables& tables) {
  const double width = width_of(options), height = height_of(options);
  const double apart_rad = resolution_m / (std::numbers::sqrt2 * std::max(range_m, resolution_m));
  BundleGrid grid{
      {}, tables.elevations_for(apart_rad), divisor_on_arc(std::max(width, height) * range_m / resolution_m)};
  const std::size_t gaps = gaps_between(width, apart_rad);
  grid.azimuths.reserve(gaps + 1);
  for (std::size_t i = 0; i <= gaps; ++i) {
    const double bearing = bearing_rad + spread_angle(width, gaps, i);
    grid.azimuths.push_back({std::cos(bearing), std::sin(bearing)});
  }
  return grid;
}

}  // namespace detail
}  // namespace pingvox
