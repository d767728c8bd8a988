#include "map/kernels/ray_aims.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <type_traits>

namespace pingvox::detail {
namespace {

// The same loops for each kind of machine.
#define PINGVOX_PLAIN_LANES 4
#define PINGVOX_LOOPS "map/kernels/ray_aims_loops.hpp"
#include "map/kernels/each_machine.hpp"

}  // namespace

template <class Point>
std::size_t aim_rays(Lanes lanes, const RayFan& fan, std::uint32_t squares, std::span<const Point> ends_m,
                     const AimedRays& aimed) {
  assert(squares > 0 &&
         std::min({aimed.places.size(), aimed.square.size(), aimed.aim.size()}) >= ends_m.size() + kWrittenBeyond);
  PINGVOX_BY_LANES(lanes, aim(fan, squares, ends_m, aimed), plain::aim(fan, squares, ends_m, aimed));
}

template std::size_t aim_rays(Lanes, const RayFan&, std::uint32_t, std::span<const Eigen::Vector3d>, const AimedRays&);
template std::size_t aim_rays(Lanes, const RayFan&, std::uint32_t, std::span<const Eigen::Vector3f>, const AimedRays&);

template <class Point>
std::size_t first_that_may_cross(Lanes lanes, const RayFan& fan, const CellAhead& cell, std::span<const Point> ends_m,
                                 std::size_t count, std::uint64_t left_out) {
  assert(count <= 64 && count <= ends_m.size());
  PINGVOX_BY_LANES(lanes, first_across(fan, cell, ends_m, count, left_out),
                   plain::first_across(fan, cell, ends_m, count, left_out));
}
template std::size_t first_that_may_cross(Lanes, const RayFan&, const CellAhead&, std::span<const Eigen::Vector3d>,
                                          std::size_t, std::uint64_t);
template std::size_t first_that_may_cross(Lanes, const RayFan&, const CellAhead&, std::span<const Eigen::Vector3f>,
                                          std::size_t, std::uint64_t);

}  // namespace pingvox::detail
