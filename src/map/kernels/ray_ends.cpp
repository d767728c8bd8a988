#include "map/kernels/ray_ends.hpp"

#include <cstring>

namespace pingvox::detail {
namespace {

namespace plain {
constexpr std::size_t kLanes = 2;
#include "map/kernels/ray_ends_loops.hpp"
}  // namespace plain

#ifdef PINGVOX_X86_LANES
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
constexpr std::size_t kLanes = 4;
#include "map/kernels/ray_ends_loops.hpp"
}  // namespace avx2
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512vl")
namespace avx512 {
constexpr std::size_t kLanes = 8;
#include "map/kernels/ray_ends_loops.hpp"
}  // namespace avx512
#pragma GCC pop_options
#endif

}  // namespace

void find_ends(const RayEnds& ends, double way_x, double way_y, std::span<const double> across, const double* up,
               std::uint64_t* places, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, find_ends(ends, way_x, way_y, across, up, places),
                   plain::find_ends(ends, way_x, way_y, across, up, places));
}

}  // namespace pingvox::detail
