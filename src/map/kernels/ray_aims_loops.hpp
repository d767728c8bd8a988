// The loops over lanes, included by ray_aims.cpp once for each kind of machine: there is no guard, and what they use
// stands there before them.

using Doubles = double __attribute__((vector_size(kLanes * sizeof(double))));
using Words = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));
using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));
using Numbers = std::int32_t __attribute__((vector_size(kLanes * sizeof(float))));

inline Floats magnitude(const Floats& numbers) {
  return reinterpret_cast<Floats>(reinterpret_cast<Numbers>(numbers) & 0x7FFFFFFF);
}

/// Coordinates of kLanes points that stand one after the other.
inline void load(const double* points, std::array<Doubles, 3>& coordinates) {
  std::array<Doubles, 3> words;
  std::memcpy(words.data(), points, sizeof words);
  for (std::size_t a = 0; a < 3; ++a) {
    // Where each lane's number stands: in the first two vectors, then in these or the third.
    Words in_two{}, in_all{};
    for (std::size_t l = 0; l < kLanes; ++l) {
      const std::size_t at = 3 * l + a;
      in_two[l] = at < 2 * kLanes ? static_cast<std::int64_t>(at) : 0;
      in_all[l] = static_cast<std::int64_t>(at < 2 * kLanes ? l : at - kLanes);
    }
    coordinates[a] = __builtin_shuffle(__builtin_shuffle(words[0], words[1], in_two), words[2], in_all);
  }
}

/// A RayFan for all lanes.
struct FanLanes {
  explicit FanLanes(const RayFan& fan) : cells_per_m(Doubles{} + fan.cells_per_m) {
    for (std::size_t a = 0; a < 3; ++a) {
      from[a] = Doubles{} + fan.from[static_cast<Eigen::Index>(a)];
      lowest[a] = Doubles{} + fan.lowest[a];
      end[a] = Doubles{} + (fan.highest[a] + 1.0);
      window_lowest[a] = Words{} + fan.window_lowest[a];
    }
  }
  Doubles cells_per_m;
  std::array<Doubles, 3> from, lowest, end;
  std::array<Words, 3> window_lowest;
};

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
  first = __builtin_shuffle(one, other, of_first);
  second = __builtin_shuffle(one, other, of_second);
}

/// Four numbers for each of the lanes.
inline void store(const Aims& aims, Aim* to) {
  using Pairs = std::int64_t __attribute__((vector_size(sizeof(Floats))));
  std::array<Floats, 2> gains, reaches;
  interleave<Floats, Numbers>(aims.across, aims.up, gains[0], gains[1]);
  interleave<Floats, Numbers>(aims.reach, Floats{}, reaches[0], reaches[1]);
  std::array<Pairs, 4> out;
  for (std::size_t half = 0; half < 2; ++half) {
    interleave<Pairs, Pairs>(reinterpret_cast<Pairs>(gains[half]), reinterpret_cast<Pairs>(reaches[half]),
                             out[2 * half], out[2 * half + 1]);
  }
  std::memcpy(static_cast<void*>(to), out.data(), sizeof out);
}

inline void aim_some(const FanLanes& fan, std::uint32_t squares, const double* ends_m, std::uint64_t* places,
                     std::uint32_t* to_squares, Aim* to_aims) {
  std::array<Doubles, 3> to;
  load(ends_m, to);
  Words inside = Words{} - 1, place{};
  for (std::size_t a = 0; a < 3; ++a) {
    to[a] *= fan.cells_per_m;
    inside &= (to[a] >= fan.lowest[a]) & (to[a] < fan.end[a]);
  }
  std::array<Floats, 3> way;
  Numbers is_lost = __builtin_convertvector(~inside, Numbers);
  for (std::size_t a = 0; a < 3; ++a) {
    to[a] = inside ? to[a] : fan.from[a];
    const Doubles exact_way = to[a] - fan.from[a];
    way[a] = __builtin_convertvector(exact_way, Floats);
    // So small that single precision does not know its sign.
    is_lost |= (way[a] == 0.0F) & __builtin_convertvector(exact_way != 0.0, Numbers);
    Words cell = __builtin_convertvector(to[a], Words);
    cell += __builtin_convertvector(cell, Doubles) > to[a];  // true is -1
    cell -= fan.window_lowest[a];
    // spread_bits, which holds for all lanes alike; the window has no more than 11 of them.
    cell = (cell | cell << 16) & 0x1F0000FF0000FF;
    cell = (cell | cell << 8) & 0x100F00F00F00F00F;
    cell = (cell | cell << 4) & 0x10C30C30C30C30C3;
    cell = (cell | cell << 2) & 0x1249249249249249;
    place |= cell << a;
  }
  place |= ~inside;
  std::memcpy(places, &place, sizeof place);
  Aims aims;
  aim_along(way, aims);
  Numbers square;
  find_squares(aims, squares, square);
  square |= is_lost;
  std::memcpy(to_squares, &square, sizeof square);
  store(aims, to_aims);
}

/// Calls f(first, points) for kLanes points each; the last ones stand together with some that mean nothing.
template <class F>
inline void for_each_lanes(std::span<const Eigen::Vector3d> points_m, F&& f) {
  const std::size_t whole = points_m.size() / kLanes * kLanes;
  for (std::size_t first = 0; first < whole; first += kLanes) f(first, points_m[first].data());
  if (whole == points_m.size()) return;
  std::array<double, 3 * kLanes> padded{};
  for (std::size_t i = 0; i < 3 * (points_m.size() - whole); ++i) padded[i] = points_m[whole].data()[i];
  f(whole, padded.data());
}

inline void aim(const RayFan& fan, std::uint32_t squares, std::span<const Eigen::Vector3d> ends_m,
                const AimedRays& aimed) {
  const FanLanes fan_lanes(fan);
  std::uint64_t* const places = aimed.place.data();
  std::uint32_t* const to_squares = aimed.square.data();
  Aim* const aims = aimed.aim.data();
  for_each_lanes(ends_m, [&](std::size_t first, const double* some_m) {
    aim_some(fan_lanes, squares, some_m, places + first, to_squares + first, aims + first);
  });
}

/// Bit l: ray l may cross the cell.
inline std::uint64_t that_may_cross(const FanLanes& fan, const CellAhead& cell, const double* ends_m) {
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
  std::array<std::uint64_t, kLanes / 2> pairs;
  std::memcpy(pairs.data(), &may, sizeof may);
  std::uint64_t any = 0;
  for (const std::uint64_t pair : pairs) any |= pair;
  if (any == 0) return 0;  // as most often
  std::uint64_t bits = 0;
  for (std::size_t l = 0; l < kLanes; ++l) bits |= static_cast<std::uint64_t>(may[l] & 1) << l;
  return bits;
}

inline std::size_t first_across(const RayFan& fan, const CellAhead& cell, std::span<const Eigen::Vector3d> ends_m,
                                std::size_t count, std::uint64_t left_out) {
  const FanLanes fan_lanes(fan);
  // Some beyond the last one do not matter, where there are some.
  const std::size_t looked = std::min(ends_m.size(), (count + kLanes - 1) / kLanes * kLanes);
  std::uint64_t may = 0;
  for_each_lanes(ends_m.first(looked), [&](std::size_t first, const double* some_m) {
    may |= that_may_cross(fan_lanes, cell, some_m) << first;
  });
  may &= ~left_out;
  return std::min(count, static_cast<std::size_t>(std::countr_zero(may)));
}
