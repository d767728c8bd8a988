#pragma once

namespace pingvox {

/// Edge [m] of a cell for a map of beams of this range and width: 0.05 m up to 10 m, and coarser by a tenth of the
/// beam's width for what lies beyond, in steps of 0.05 m. Of a head with a beam of 3 degrees 0.1 m at 20 m and 0.25 m
/// at 50 m. A beam widens with its range and resolves nothing finer; cells that do not grow with it cost time and
/// memory by the third power of the range. REQUIRES range_m >= 0 and beam_width_rad >= 0, both finite.
double resolution_for(double range_m, double beam_width_rad);

}  // namespace pingvox
