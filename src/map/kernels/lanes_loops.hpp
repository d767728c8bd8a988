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

/// Asks for the points some way ahead, beyond the page where the machine stops to do so by itself.
inline void fetch_ahead(std::span<const Eigen::Vector3d> points_m, std::size_t first) {
  constexpr std::size_t kAhead = 64, kPerLine = 2;
  for (std::size_t l = 0; l < kLanes; l += kPerLine) {
    __builtin_prefetch(&points_m[std::min(first + kAhead + l, points_m.size() - 1)]);
  }
}

/// Calls f(first, points) for kLanes points each; the last ones stand together with some that are no
/// numbers, and so outside of any window.
template <class F>
inline void for_each_lanes(std::span<const Eigen::Vector3d> points_m, F&& f) {
  const std::size_t whole = points_m.size() / kLanes * kLanes;
  std::array<double, 3 * kLanes> padded;
  padded.fill(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = whole; i < points_m.size(); ++i) {
    std::memcpy(&padded[3 * (i - whole)], points_m[i].data(), 3 * sizeof(double));
  }
  // f stands here once, so that it becomes part of the loop.
  for (std::size_t first = 0; first < points_m.size(); first += kLanes) {
    const double* const some_m = points_m[first].data();
    fetch_ahead(points_m, first);
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
inline void load_in(const FanLanes& fan, const double* points_m, PointLanes& points) {
  load(points_m, points.at);
  points.is_inside = Words{} - 1;
  for (std::size_t a = 0; a < 3; ++a) {
    points.at[a] *= fan.cells_per_m;
    points.is_inside &= (points.at[a] >= fan.lowest[a]) & (points.at[a] < fan.end[a]);
  }
  for (std::size_t a = 0; a < 3; ++a) points.at[a] = points.is_inside ? points.at[a] : fan.from[a];
}

/// Which of the lanes: what compares words, and chooses among them.
#ifdef PINGVOX_AVX512
using Which = __mmask8;
inline void differ(const Words& one, const Words& other, Which& which) {
  which = _mm512_cmpneq_epi64_mask(reinterpret_cast<__m512i>(one), reinterpret_cast<__m512i>(other));
}
inline void keep_unless(Which which, Words& words) {
  words = reinterpret_cast<Words>(_mm512_mask_mov_epi64(reinterpret_cast<__m512i>(words), which, __m512i{}));
}
/// The bit of a cell in its brick.
inline void bit_of(const Words& cell, Words& bit) {
  bit = reinterpret_cast<Words>(_mm512_maskz_rolv_epi64(0xFF, _mm512_set1_epi64(1), reinterpret_cast<__m512i>(cell)));
}
/// Stores the words of those lanes, one after the other, where there is room for all of them. @return how many
inline std::size_t store_some(Which which, const Words& words, std::uint64_t* to) {
  _mm512_storeu_si512(to, _mm512_maskz_compress_epi64(which, reinterpret_cast<__m512i>(words)));
  return static_cast<std::size_t>(__builtin_popcount(which));
}
#else
using Which = Words;
inline void differ(const Words& one, const Words& other, Which& which) {
  which = one != other;
}
inline void keep_unless(const Which& which, Words& words) {
  words &= ~which;
}
inline void bit_of(const Words& cell, Words& bit) {
  bit = (Words{} + 1) << (cell & 63);
}
inline std::size_t store_some(const Which& which, const Words& words, std::uint64_t* to) {
  std::size_t count = 0;
  for (std::size_t l = 0; l < kLanes; ++l) {
    to[count] = static_cast<std::uint64_t>(words[l]);
    count -= static_cast<std::size_t>(which[l]);
  }
  return count;
}
#endif

inline bool are_all(const Words& truth) {
  std::int64_t all = -1;
  for (std::size_t l = 0; l < kLanes; ++l) all &= truth[l];
  return all != 0;
}

/// Finds the cells that hold points, and of points in a row that share theirs only one.
class CellsInARow {
 public:
  explicit CellsInARow(std::uint64_t* to) : to_(to) {}

  /// Takes in the cells of kLanes points, where there is room for kLanes.
  void add(const FanLanes& fan, const PointLanes& points) {
    Words cells = ~points.is_inside;
    for (std::size_t a = 0; a < 3; ++a) {
      Words cell;
      floor_of(points.at[a], cell);
      cells |= (cell - fan.window_lowest[a]) << (kBitsOfAxis * static_cast<int>(a));
    }
    Words before, one_back;
    for (std::size_t l = 0; l < kLanes; ++l) one_back[l] = static_cast<std::int64_t>(kLanes - 1 + l);
    pick(last_, cells, one_back, before);
    Which others;
    differ(cells, points.is_inside ? before : cells, others);
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
