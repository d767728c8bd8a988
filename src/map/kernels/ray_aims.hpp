#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "map/kernels/lanes.hpp"
#include "map/kernels/ray_lanes.hpp"

/// Which way rays from one place go, several at a time, in single precision: good enough to tell which of them may
/// cross a cell, and which surely do not.
namespace pingvox::detail {

/// Where a ray goes, in steps that never turn the order of two round and tell a positive number, a negative one and
/// zero apart; and the same with the other sign. So of several rays the least of each number is what all of them stay
/// within. A ray leaves through a face of the cube around the place where it begins, that of the axis along which it
/// goes farthest.
using Aim = std::int16_t __attribute__((vector_size(8 * sizeof(std::int16_t))));
inline constexpr int kAcross = 0;   ///< what it gains along the next axis for each cell along the face's: -1..1
inline constexpr int kUp = 1;       ///< the same along the axis after that
inline constexpr int kReach = 2;    ///< how far it goes along the face's axis [cells]
inline constexpr int kNegated = 4;  ///< added to these
inline constexpr float kStepsOfGain = 16384.0F, kStepsOfReach = 24.0F;

// No ray of a window is so long that its steps do not fit (the window is placed around its start, to a page).
static_assert(((1 << (ScanWindow::kMostBits - 1)) + (1 << 4)) * kStepsOfReach < 32000.0F);

/// Four numbers, times kStepsOfGain or kStepsOfReach, in steps.
using FourNumbers = float __attribute__((vector_size(4 * sizeof(float))));
using FourSteps = std::int32_t __attribute__((vector_size(4 * sizeof(std::int32_t))));
inline FourSteps in_steps(const FourNumbers& numbers) {
  const FourNumbers most = FourNumbers{} + 32000.0F;  // of 16 bits
  const FourNumbers above = numbers > -most ? numbers : -most, within = above < most ? above : most;
  return __builtin_convertvector(within, FourSteps) - (numbers > 0.0F) + (numbers < 0.0F);  // true is -1
}

/// Whether any number of an aim is greater.
inline bool is_any_greater(const Aim& aim, const Aim& most) {
  const Aim greater = aim > most;
#ifdef __SSE2__
  return _mm_movemask_epi8(reinterpret_cast<__m128i>(greater)) != 0;
#else
  std::int16_t any = 0;
  for (int i = 0; i < 8; ++i) any = static_cast<std::int16_t>(any | greater[i]);
  return any != 0;
#endif
}

/// The squares that the faces are cut into are numbered by (face * squares + row) * squares + column, rows by kUp,
/// columns by kAcross; faces by 2 * axis, one more for rays that go back along it.
/// @param gain  across or up  @param squares  along an edge of the face
inline std::uint32_t square_along(float gain, std::uint32_t squares) {
  const float at = (gain + 1.0F) * (0.5F * static_cast<float>(squares));
  return at <= 0.0F ? 0 : (at >= static_cast<float>(squares) ? squares - 1 : static_cast<std::uint32_t>(at));
}

/// What aim_rays finds out of some rays.
struct AimedRays {
  std::span<std::uint64_t> places;  ///< as find_cells has them
  std::span<std::uint32_t> square;  ///< kNoSquare: outside of the window, or too close for an aim
  std::span<Aim> aim;
};
inline constexpr std::uint32_t kNoSquare = ~std::uint32_t{0};

/// Aims of the rays to `ends_m` [m, map frame], and the places of their ends.
/// @tparam Point  Eigen::Vector3d or Eigen::Vector3f
/// @return how many places
/// REQUIRES room for kWrittenBeyond more than there are ends
template <class Point>
std::size_t aim_rays(Lanes lanes, const RayFan& fan, std::uint32_t squares, std::span<const Point> ends_m,
                     const AimedRays& aimed);

/// A cell as rays through one face come to it [cells, from the place where they begin].
struct CellAhead {
  float near, far;   ///< along the face's axis; near >= 0
  float across, up;  ///< its middle
  float half_width;  ///< half a cell and a little more
};

/// @param ends_m    where rays end; what follows the first `count` of them means nothing
/// @param left_out  bit i: not ray i
/// @return number of the first of these rays that may cross a cell; `count` when surely none does
/// REQUIRES count <= 64, and that all go through the same face
template <class Point>
std::size_t first_that_may_cross(Lanes lanes, const RayFan& fan, const CellAhead& cell, std::span<const Point> ends_m,
                                 std::size_t count, std::uint64_t left_out);

}  // namespace pingvox::detail
