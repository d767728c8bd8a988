#include "mapping/elevation_tables.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/kernels/ray_ends.hpp"

namespace pingvox::detail {

std::size_t gaps_between(double width_rad, double apart_rad) {
  return width_rad <= 0.0 ? 0 : static_cast<std::size_t>(std::max(1.0, std::ceil(width_rad / apart_rad)));
}

double spread_angle(double width_rad, std::size_t gaps, std::size_t i) {
  return gaps == 0 ? 0.0 : width_rad * (static_cast<double>(i) / static_cast<double>(gaps) - 0.5);
}

double vertical_pattern(double elevation_rad, double height_rad) {
  const double off_axis = height_rad > 0.0 ? std::clamp(2.0 * elevation_rad / height_rad, -1.0, 1.0) : 0.0;
  return std::exp2(-off_axis * off_axis);
}

Elevations::Elevations(double height_rad, std::size_t gaps)
    : count(gaps + 1), across(count + kEndsAtOnce), up(count + kEndsAtOnce), pattern(count) {
  for (std::size_t i = 0; i < count; ++i) {
    const double elevation = spread_angle(height_rad, gaps, i);
    across[i] = std::cos(elevation);
    up[i] = std::sin(elevation);
    pattern[i] = vertical_pattern(elevation, height_rad);
  }
}

const Elevations& ElevationTables::elevations_for(double apart_rad) {
  const std::size_t gaps = gaps_between(height_rad_, apart_rad);
  if (gaps >= kMaxKept) return large_.emplace(height_rad_, gaps);
  if (gaps >= kept_.size()) kept_.resize(gaps + 1);
  std::optional<Elevations>& table = kept_[gaps];
  if (!table) table.emplace(height_rad_, gaps);
  return *table;
}

}  // namespace pingvox::detail
