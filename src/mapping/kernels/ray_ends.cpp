#include "mapping/kernels/ray_ends.hpp"

#include <cstring>

namespace pingvox::detail {
namespace {

#define PINGVOX_LOOPS "mapping/kernels/ray_ends_loops.hpp"
#include "map/kernels/each_machine.hpp"

}  // namespace

void find_ends(const RayEnds& ends, double way_x, double way_y, std::span<const double> across, const double* up,
               std::uint64_t* places, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, find_ends(ends, way_x, way_y, across, up, places),
                   plain::find_ends(ends, way_x, way_y, across, up, places));
}

}  // namespace pingvox::detail
