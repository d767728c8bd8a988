// The loops over lanes, included by ray_aims.cpp once for each kind of machine: there is no guard, and what they use
// stands there before them.

#include "map/kernels/lanes_loops.hpp"

using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));
using Numbers = std::int32_t __attribute__((vector_size(kLanes * sizeof(float))));

inline Floats magnitude(const Floats& numbers) {
  return reinterpret_cast<Floats>(reinterpret_cast<Numbers>(numbers) & 0x7FFFFFFF);
}

/// Aims of kLanes rays, and what it takes to find their squares.
struct Aims {
  Floats across, up, reach;
  Numbers face;
};

inline void aim_along(const std::array<Floats, 3>& way, Aims& aims) {
  const Floats x = magnitude(way[0]), y = magnitude(way[1]), z = magnitude(way[2]);
  const Numbers is_x = (x >= y) & (x >= z), is_y = ~is_x & (y >= z);
  const Floats along = is_x ? way[0] : (is_y ? way[1] : way[2]);
  const Floats next = is_x ? way[1] : (is_y ? way[2] : way[0]);
  const Floats after = is_x ? way[2] : (is_y ? way[0] : way[1]);
  const Floats shortest = Floats{} + 1e-30F;
  aims.reach = magnitude(along);
  aims.reach = aims.reach > shortest ? aims.reach : shortest;
  const Floats per_cell = 1.0F / aims.reach;
  aims.across = next * per_cell;
  aims.up = after * per_cell;
  aims.face = (is_x ? Numbers{} : (is_y ? Numbers{} + 2 : Numbers{} + 4)) - (along < 0.0F);
}

/// square_along for each lane.
inline void find_squares(const Aims& aims, std::uint32_t squares, Numbers& square) {
  const float half = 0.5F * static_cast<float>(squares);
  const auto edge = static_cast<std::int32_t>(squares);
  Numbers column = __builtin_convertvector((aims.across + 1.0F) * half, Numbers);
  Numbers row = __builtin_convertvector((aims.up + 1.0F) * half, Numbers);
  column = column < edge ? column : Numbers{} + (edge - 1);
  row = row < edge ? row : Numbers{} + (edge - 1);
  square = (aims.face * edge + row) * edge + column;
}

/// Lane by lane: the first half of one vector and of another by turns, or the second half of both.
template <class Vector, class Place>
inline void interleave(const Vector& one, const Vector& other, Vector& first, Vector& second) {
  constexpr std::size_t kCount = sizeof(Place) / sizeof(Place{}[0]);
  Place of_first{}, of_second{};
  for (std::size_t l = 0; l < kCount; ++l) {
    const std::size_t from = l / 2 + (l % 2) * kCount;
    of_first[l] = static_cast<std::remove_reference_t<decltype(Place{}[0])>>(from);
    of_second[l] = static_cast<std::remove_reference_t<decltype(Place{}[0])>>(from + kCount / 2);
  }
  pick(one, other, of_first, first);
  pick(one, other, of_second, second);
}

/// in_steps for each lane. REQUIRES numbers that fit
inline Numbers steps_of(const Floats& numbers) {
  return __builtin_convertvector(numbers, Numbers) - (numbers > 0.0F) + (numbers < 0.0F);  // true is -1
}

/// Two numbers of 16 bits in one of 32.
inline void pair(const Numbers& low, const Numbers& high, Numbers& both) {
  using Unsigned = std::uint32_t __attribute__((vector_size(sizeof(Numbers))));
  both =
      reinterpret_cast<Numbers>((reinterpret_cast<Unsigned>(low) & 0xFFFFU) | (reinterpret_cast<Unsigned>(high) << 16));
}

/// An aim for each of the lanes.
inline void store(const Aims& aims, Aim* to) {
  using Pairs = std::int64_t __attribute__((vector_size(sizeof(Floats))));
  const Numbers across = steps_of(aims.across * kStepsOfGain), up = steps_of(aims.up * kStepsOfGain),
                reach = steps_of(aims.reach * kStepsOfReach);
  std::array<Numbers, 4> pairs;
  pair(across, up, pairs[0]);
  pair(reach, Numbers{}, pairs[1]);
  pair(-across, -up, pairs[2]);
  pair(-reach, Numbers{}, pairs[3]);
  std::array<Numbers, 2> first, second;
  interleave<Numbers, Numbers>(pairs[0], pairs[1], first[0], first[1]);
  interleave<Numbers, Numbers>(pairs[2], pairs[3], second[0], second[1]);
  // Each vector by itself: an array of them would be copied in larger pieces than it was just stored in, which waits.
  auto* const bytes = reinterpret_cast<std::byte*>(to);
  for (std::size_t half = 0; half < 2; ++half) {
    Pairs low, high;
    interleave<Pairs, Pairs>(reinterpret_cast<Pairs>(first[half]), reinterpret_cast<Pairs>(second[half]), low, high);
    std::memcpy(bytes + 2 * half * sizeof low, &low, sizeof low);
    std::memcpy(bytes + (2 * half + 1) * sizeof low, &high, sizeof high);
  }
}

inline void aim_some(const FanLanes& fan, std::uint32_t squares, const PointLanes& ends, std::uint32_t* to_squares,
                     Aim* to_aims) {
  std::array<Floats, 3> way;
  Numbers is_lost = __builtin_convertvector(~ends.is_inside, Numbers);
  for (std::size_t a = 0; a < 3; ++a) {
    const Doubles exact_way = ends.at[a] - fan.from[a];
    way[a] = __builtin_convertvector(exact_way, Floats);
    // So small that single precision does not know its sign.
    is_lost |= (way[a] == 0.0F) & __builtin_convertvector(exact_way != 0.0, Numbers);
  }
  Aims aims;
  aim_along(way, aims);
  Numbers square;
  find_squares(aims, squares, square);
  square |= is_lost;
  std::memcpy(to_squares, &square, sizeof square);
  store(aims, to_aims);
}

template <class Point>
inline std::size_t aim(const RayFan& fan, std::uint32_t squares, std::span<const Point> ends_m,
                       const AimedRays& aimed) {
  const FanLanes fan_lanes(fan);
  CellsInARow cells(aimed.places.data());
  std::uint32_t* const to_squares = aimed.square.data();
  Aim* const aims = aimed.aim.data();
  for_each_lanes(ends_m, [&](std::size_t first, const auto* some_m) {
    PointLanes ends;
    load_in(fan_lanes, some_m, ends);
    cells.add(fan_lanes, ends);
    aim_some(fan_lanes, squares, ends, to_squares + first, aims + first);
  });
  return cells.finish();
}

/// Bit l: lane l is true.
inline std::uint64_t bits_of(const Numbers& truth) {
#ifdef PINGVOX_AVX512
  return _mm256_movepi32_mask(reinterpret_cast<__m256i>(truth));
#else
  std::array<std::uint64_t, kLanes / 2> pairs;
  std::memcpy(pairs.data(), &truth, sizeof truth);
  std::uint64_t any = 0;
  for (const std::uint64_t pair : pairs) any |= pair;
  if (any == 0) return 0;  // as most often
  std::uint64_t bits = 0;
  for (std::size_t l = 0; l < kLanes; ++l) bits |= static_cast<std::uint64_t>(truth[l] & 1) << l;
  return bits;
#endif
}

/// Bit l: ray l may cross the cell.
template <class Real>
inline std::uint64_t that_may_cross(const FanLanes& fan, const CellAhead& cell, const Real* ends_m) {
  std::array<Doubles, 3> to;
  load(ends_m, to);
  std::array<Floats, 3> way;
  for (std::size_t a = 0; a < 3; ++a) {
    way[a] = __builtin_convertvector(to[a] * fan.cells_per_m - fan.from[a], Floats);
  }
  Aims aims;
  aim_along(way, aims);
  const Floats far = Floats{} + cell.far;
  const Floats end = aims.reach < far ? aims.reach : far;
  const float left = cell.across - cell.half_width, right = cell.across + cell.half_width;
  const float below = cell.up - cell.half_width, above = cell.up + cell.half_width;
  const Floats across_near = aims.across * cell.near, across_end = aims.across * end;
  const Floats up_near = aims.up * cell.near, up_end = aims.up * end;
  const Numbers is_level = ((across_near < right) | (across_end < right)) &
                           ((across_near > left) | (across_end > left)) & ((up_near < above) | (up_end < above)) &
                           ((up_near > below) | (up_end > below));
  // Seen along the face's axis its way is a line through the middle; the cell must lie on both sides of it.
  const Numbers is_astride = magnitude(aims.across * cell.up - aims.up * cell.across) <=
                             (magnitude(aims.across) + magnitude(aims.up)) * cell.half_width;
  const Numbers may = (aims.reach >= cell.near) & is_level & is_astride;
  return bits_of(may);
}

template <class Point>
inline std::size_t first_across(const RayFan& fan, const CellAhead& cell, std::span<const Point> ends_m,
                                std::size_t count, std::uint64_t left_out) {
  const FanLanes fan_lanes(fan);
  // Some beyond the last one do not matter, where there are some.
  const std::size_t looked = std::min(ends_m.size(), (count + kLanes - 1) / kLanes * kLanes);
  std::uint64_t may = 0;
  for_each_lanes(ends_m.first(looked), [&](std::size_t first, const auto* some_m) {
    may |= that_may_cross(fan_lanes, cell, some_m) << first;
  });
  may &= ~left_out;
  return std::min(count, static_cast<std::size_t>(std::countr_zero(may)));
}
