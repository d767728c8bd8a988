// What the loops over lanes share, included before them once for each kind of machine (see doubles_loops.hpp).

#include "map/kernels/doubles_loops.hpp"

/// Largest whole numbers that are not larger. REQUIRES numbers below 2^53.
inline void floor_of(const Doubles& numbers, Words& whole) {
  whole = __builtin_convertvector(numbers, Words);
  whole += __builtin_convertvector(whole, Doubles) > numbers;  // true is -1
}

/// spread_bits for each lane. REQUIRES up to 11 bits, as many as a window's cells have
inline void spread(Words& words) {
  words = (words | words << 16) & 0x1F0000FF0000FF;
  words = (words | words << 8) & 0x100F00F00F00F00F;
  words = (words | words << 4) & 0x10C30C30C30C30C3;
  words = (words | words << 2) & 0x1249249249249249;
}

/// Lanes of two vectors: those of the other one are numbered on.
template <class Vector, class Places>
inline void pick(const Vector& one, const Vector& other, const Places& places, Vector& to) {
#ifdef __clang__
  constexpr std::size_t kCount = sizeof(Places) / sizeof(places[0]);
  for (std::size_t l = 0; l < kCount; ++l) {
    const auto from = static_cast<std::size_t>(places[l]);
    to[l] = from < kCount ? one[from] : other[from - kCount];
  }
#else
  to = __builtin_shuffle(one, other, places);
#endif
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
    Doubles of_two;
    pick(words[0], words[1], in_two, of_two);
    pick(of_two, words[2], in_all, coordinates[a]);
  }
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

/// Points in cells, and which of them are inside of the window.
struct PointLanes {
  std::array<Doubles, 3> at;
  Words is_inside;
};

/// @param points_m  kLanes of them; those outside become the place where rays begin
inline void load_in(const FanLanes& fan, const double* points_m, PointLanes& points) {
  load(points_m, points.at);
  points.is_inside = Words{} - 1;
  for (std::size_t a = 0; a < 3; ++a) {
    points.at[a] *= fan.cells_per_m;
    points.is_inside &= (points.at[a] >= fan.lowest[a]) & (points.at[a] < fan.end[a]);
  }
  for (std::size_t a = 0; a < 3; ++a) points.at[a] = points.is_inside ? points.at[a] : fan.from[a];
}

/// Places of cells in the window; all bits (kNowhere) for points outside.
inline void find_places(const FanLanes& fan, const PointLanes& points, Words& place) {
  place = ~points.is_inside;
  for (std::size_t a = 0; a < 3; ++a) {
    Words cell;
    floor_of(points.at[a], cell);
    cell -= fan.window_lowest[a];
    spread(cell);
    place |= cell << a;
  }
}
