#include "pingvox/mapping/map_resolution.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox {

double resolution_for(double range_m, double beam_width_rad) {
  assert(std::isfinite(range_m) && range_m >= 0.0 && std::isfinite(beam_width_rad) && beam_width_rad >= 0.0);
  constexpr double kFine_m = MapOptions::kDefaultResolution_m, kFineRange_m = 10.0, kCellsAcross = 10.0;
  // A range that is asked of a head and the one that it records differ a little.
  const double beyond_m = std::max(0.0, std::round(range_m) - kFineRange_m);
  const double steps = std::round(beyond_m * beam_width_rad / kCellsAcross / kFine_m);
  // Divided, so that it is the number that one would type: 0.15, not 0.15000000000000002.
  constexpr double kStepsPerMetre = 20.0;
  return (1.0 + steps) / kStepsPerMetre;
}

}  // namespace pingvox
