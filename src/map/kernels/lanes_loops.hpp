// What the loops over lanes share, included before them once for each kind of machine (see doubles_loops.hpp).

#include "map/kernels/doubles_loops.hpp"

/// Largest whole numbers that are not larger. REQUIRES numbers below 2^51.
inline void floor_of(const Doubles& numbers, Words& whole) {
#ifdef PINGVOX_AVX512
  constexpr int kDown = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
  whole = reinterpret_cast<Words>(_mm512_cvt_roundpd_epi64(reinterpret_cast<__m512d>(numbers), kDown));
#else
  const Doubles near = numbers + kWhole;
  whole = reinterpret_cast<Words>(near) - std::bit_cast<std::int64_t>(kWhole);
  whole += near - kWhole > numbers;  // true is -1
#endif
}

/// spread_bits for each lane. REQUIRES up to 11 bits, as many as a window's cells have
inline void spread(Words& words) {
  words = (words | words << 16) & 0x1F0000FF0000FF;
  words = (words | words << 8) & 0x100F00F00F00F00F;
  words = (words | words << 4) & 0x10C30C30C30C30C3;
  words = (words | words << 2) & 0x1249249249249249;
}

/// Takes every third bit, up to 11 of them.
inline void gather_bits(Words& words) {
  words &= 0x1249249249249249;
  words = (words | words >> 2) & 0x10C30C30C30C30C3;
  words = (words | words >> 4) & 0x100F00F00F00F00F;
  words = (words | words >> 8) & 0x1F0000FF0000FF;
  words = (words | words >> 16) & 0x7FF;
}

/// Coordinates of points that stand one after the other, as many as a vector has lanes.
/// @tparam Places  numbers of lanes, as wide as the coordinates
template <class Places, class Real, class Vector>
inline void load_each(const Real* points, std::array<Vector, 3>& coordinates) {
  constexpr std::size_t kCount = sizeof(Vector) / sizeof(Real);
  using Place = std::remove_cvref_t<decltype(Places{}[0])>;
  // Each by itself: copied as an array they would be written to memory once more.
  Vector first, second, third;
  std::memcpy(&first, points, sizeof first);
  std::memcpy(&second, points + kCount, sizeof second);
  std::memcpy(&third, points + 2 * kCount, sizeof third);
  for (std::size_t a = 0; a < 3; ++a) {
    // Where each lane's number stands: in the first two vectors, then in these or the third.
    Places in_two{}, in_all{};
    for (std::size_t l = 0; l < kCount; ++l) {
      const std::size_t at = 3 * l + a;
      in_two[l] = static_cast<Place>(at < 2 * kCount ? at : 0);
      in_all[l] = static_cast<Place>(at < 2 * kCount ? l : at - kCount);
    }
    Vector of_two;
    pick(first, second, in_two, of_two);
    pick(of_two, third, in_all, coordinates[a]);
  }
}

/// Coordinates of kLanes points.
inline void load(const double* points, std::array<Doubles, 3>& coordinates) {
  load_each<Words>(points, coordinates);
}

inline void load(const float* points, std::array<Doubles, 3>& coordinates) {
#ifdef PINGVOX_AVX512
  const __m512 in_first = _mm512_loadu_ps(points), in_second = _mm512_castps256_ps512(_mm256_loadu_ps(points + 16));
  const __m512i every_third = _mm512_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21, 0, 0, 0, 0, 0, 0, 0, 0);
  for (std::size_t a = 0; a < 3; ++a) {
    const __m512i from = _mm512_add_epi32(every_third, _mm512_set1_epi32(static_cast<int>(a)));
    const __m512 along = _mm512_permutex2var_ps(in_first, from, in_second);
    __m256 eight;
    std::memcpy(&eight, &along, sizeof eight);
    coordinates[a] = reinterpret_cast<Doubles>(_mm512_maskz_cvtps_pd(0xFF, eight));
  }
#elif defined(PINGVOX_AVX2)
  using Fours = float __attribute__((vector_size(4 * sizeof(float))));
  using Places = std::int32_t __attribute__((vector_size(sizeof(Fours))));
  std::array<Fours, 3> fours;
  load_each<Places>(points, fours);
  for (std::size_t a = 0; a < 3; ++a) coordinates[a] = __builtin_convertvector(fours[a], Doubles);
#else
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t l = 0; l < kLanes; ++l) coordinates[a][l] = points[3 * l + a];
  }
#endif
}

/// Asks for as many points some way ahead, beyond the page where the machine stops to do so by itself. Beyond the last
/// one too, where often the next block begins: asking reads nothing.
template <std::size_t Count, class Point>
inline void fetch_ahead(std::span<const Point> points_m, std::size_t first) {
  constexpr std::size_t kAhead = 3072, kLine = 64;
  const auto begin = reinterpret_cast<std::uintptr_t>(points_m.data());
  for (std::size_t byte = 0; byte < Count * sizeof(Point); byte += kLine) {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): an address, as no pointer may be made that far beyond the end
    __builtin_prefetch(reinterpret_cast<const void*>(begin + first * sizeof(Point) + kAhead + byte));
  }
}

/// Calls f(first, points) for `Count` points each; the last ones stand together with some that are no
/// numbers, and so outside of any window.
template <std::size_t Count = kLanes, class Point, class F>
inline void for_each_lanes(std::span<const Point> points_m, F&& f) {
  using Real = typename Point::Scalar;
  const std::size_t whole = points_m.size() / Count * Count;
  std::array<Real, 3 * Count> padded;
  padded.fill(std::numeric_limits<Real>::quiet_NaN());
  for (std::size_t i = whole; i < points_m.size(); ++i) {
    std::memcpy(&padded[3 * (i - whole)], points_m[i].data(), sizeof(Point));
  }
  // f stands here once, so that it becomes part of the loop.
  for (std::size_t first = 0; first < points_m.size(); first += Count) {
    const Real* const some_m = points_m[first].data();
    fetch_ahead<Count>(points_m, first);
    f(first, first < whole ? some_m : padded.data());
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

/// Points in cells, and which of them are inside of the window.
struct PointLanes {
  std::array<Doubles, 3> at;
  Words is_inside;
};

/// @param points_m  kLanes of them; those outside become the place where rays begin
template <class Real>
inline void load_in(const FanLanes& fan, const Real* points_m, PointLanes& points) {
  load(points_m, points.at);
  points.is_inside = Words{} - 1;
  for (std::size_t a = 0; a < 3; ++a) {
    points.at[a] *= fan.cells_per_m;
    points.is_inside &= (points.at[a] >= fan.lowest[a]) & (points.at[a] < fan.end[a]);
  }
  for (std::size_t a = 0; a < 3; ++a) points.at[a] = points.is_inside ? points.at[a] : fan.from[a];
}

/// Some of the lanes.
#ifdef PINGVOX_AVX512
using Some = __mmask8;
inline void find_different(const Words& one, const Words& other, Some& some) {
  some = _mm512_cmpneq_epi64_mask(reinterpret_cast<__m512i>(one), reinterpret_cast<__m512i>(other));
}
inline void clear_some(Some some, Words& words) {
  words = reinterpret_cast<Words>(_mm512_mask_mov_epi64(reinterpret_cast<__m512i>(words), some, __m512i{}));
}
/// Stores the words of these lanes, one after the other, where there is room for all of them. @return how many
inline std::size_t store_some(Some some, const Words& words, std::uint64_t* to) {
  _mm512_storeu_si512(to, _mm512_maskz_compress_epi64(some, reinterpret_cast<__m512i>(words)));
  return static_cast<std::size_t>(__builtin_popcount(some));
}
#else
#ifdef PINGVOX_AVX2
/// Of four words some: how many, and where their halves stand; what follows these means nothing.
struct OfFour {
  std::array<std::uint8_t, 8> halves{};
  std::uint64_t count = 0;
};
/// For each choice of words that are left out, a bit each.
constexpr std::array<OfFour, 16> kLeavingOut = [] {
  std::array<OfFour, 16> all{};
  for (std::size_t left_out = 0; left_out < all.size(); ++left_out) {
    OfFour& some = all[left_out];
    for (std::size_t half = 0; half < 8; ++half) {
      if ((left_out >> half / 2 & 1) == 0) some.halves[some.count++] = static_cast<std::uint8_t>(half);
    }
    some.count /= 2;
  }
  return all;
}();
#endif
/// Kept as the lanes left out: that is what a comparison for being equal gives, without a step to turn it around.
struct Some {
  Words left_out;  ///< true is -1
};
inline void find_different(const Words& one, const Words& other, Some& some) {
  some.left_out = one == other;
}
inline void clear_some(const Some& some, Words& words) {
  words &= some.left_out;
}
inline std::size_t store_some(const Some& some, const Words& words, std::uint64_t* to) {
#ifdef PINGVOX_AVX2
  const auto left_out = static_cast<std::size_t>(_mm256_movemask_pd(reinterpret_cast<__m256d>(some.left_out)));
  const OfFour& chosen = kLeavingOut[left_out];
  const __m128i halves = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(chosen.halves.data()));
  const __m256i together = _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(words), _mm256_cvtepu8_epi32(halves));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), together);
  return chosen.count;
#else
  std::size_t count = 0;
  for (std::size_t l = 0; l < kLanes; ++l) {
    to[count] = static_cast<std::uint64_t>(words[l]);
    count += static_cast<std::size_t>(1 + some.left_out[l]);
  }
  return count;
#endif
}
#endif

inline bool are_all(const Words& truth) {
#ifdef PINGVOX_AVX512
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(truth)) == 0xFF;
#else
  std::int64_t all = -1;
  for (std::size_t l = 0; l < kLanes; ++l) all &= truth[l];
  return all != 0;
#endif
}

/// Numbers of the cells of points, counted from the window's first one: Bits an axis, x in the lowest; all bits set of
/// points outside.
template <int Bits>
inline void number_cells(const FanLanes& fan, const PointLanes& points, Words& cells) {
  cells = ~points.is_inside;
  for (std::size_t a = 0; a < 3; ++a) {
    Words cell;
    floor_of(points.at[a], cell);
    cells |= (cell - fan.window_lowest[a]) << (Bits * static_cast<int>(a));
  }
}

/// Finds the cells that hold points, and of points in a row that share theirs only one.
class CellsInARow {
 public:
  explicit CellsInARow(std::uint64_t* to) : to_(to) {}

  /// Takes in the cells of kLanes points, where there is room for kLanes.
  void add(const FanLanes& fan, const PointLanes& points) {
    Words cells, before, one_back;
    number_cells<kBitsOfAxis>(fan, points, cells);
    for (std::size_t l = 0; l < kLanes; ++l) one_back[l] = static_cast<std::int64_t>(kLanes - 1 + l);
    pick(last_, cells, one_back, before);
    Some others;
    find_different(cells, points.is_inside ? before : cells, others);
    count_ += store_some(others, cells, to_ + count_);
    last_ = cells;
  }
  /// Makes places of them (numbers of cells in the window). @return how many. To be called last.
  std::size_t finish() {
    for (std::size_t i = 0; i < count_; i += kLanes) {
      Words cells, place{};
      std::memcpy(&cells, to_ + i, sizeof cells);
      for (std::size_t a = 0; a < 3; ++a) {
        Words cell = (cells >> (kBitsOfAxis * static_cast<int>(a))) & ((1 << kBitsOfAxis) - 1);
        spread(cell);
        place |= cell << a;
      }
      std::memcpy(to_ + i, &place, sizeof place);
    }
    return count_;
  }

 private:
  static constexpr int kBitsOfAxis = 16;
  std::uint64_t* to_;
  std::size_t count_ = 0;
  Words last_ = Words{} - 1;
};
