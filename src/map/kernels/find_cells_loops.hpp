// Loops over lanes that find the cells of points, included by ray_lanes.cpp behind ray_lanes_loops.hpp.

template <class Point>
inline std::size_t find_in_doubles(const RayFan& fan, std::span<const Point> points_m, std::uint64_t* places,
                                   std::vector<std::uint32_t>& outside) {
  const FanLanes fan_lanes(fan);
  CellsInARow cells(places);
  for_each_lanes(points_m, [&](std::size_t first, const auto* some_m) {
    PointLanes points;
    load_in(fan_lanes, some_m, points);
    cells.add(fan_lanes, points);
    if (are_all(points.is_inside)) return;  // as most often
    for (std::size_t l = 0; l < std::min(kLanes, points_m.size() - first); ++l) {
      if (points.is_inside[l] == 0) outside.push_back(static_cast<std::uint32_t>(first + l));
    }
  });
  return cells.finish();
}

/// In single precision, twice as many stand side by side.
constexpr std::size_t kFloats = 2 * kLanes;
using Floats = float __attribute__((vector_size(kFloats * sizeof(float))));
using Signed = std::int32_t __attribute__((vector_size(sizeof(Floats))));
using Numbers = std::uint32_t __attribute__((vector_size(sizeof(Floats))));
using HalfNumbers = std::uint32_t __attribute__((vector_size(sizeof(Floats) / 2)));

/// kWhole for floats. REQUIRES numbers below 2^22
constexpr float kWholeFloat = 0x1.8p23F;

/// Bits of an axis in the number of a cell that has 32.
constexpr int kBitsOfNumber = 10;

/// A RayFan for floats.
struct FloatFan {
  explicit FloatFan(const RayFan& fan) {
    if (!(fan.cells_per_m < 0x1p100)) return;
    const auto per_m = static_cast<float>(fan.cells_per_m);
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
#ifdef PINGVOX_AVX512
    const bool is_less = static_cast<double>(per_m) < fan.cells_per_m;
    const bool is_more = static_cast<double>(per_m) > fan.cells_per_m;
    at_least = Floats{} + (is_more ? std::nextafter(per_m, 0.0F) : per_m);
    at_most = Floats{} + (is_less ? std::nextafter(per_m, kInfinity) : per_m);
    // Products lie farther apart the larger they are; beyond this they would not name the same cell often enough.
    const double farthest = is_less || is_more ? 0x1p17 : 0x1p21;
#else
    if (!(fan.cells_per_m >= 1.0)) return;  // or products of the least numbers would become nothing
    at_least = Floats{} + std::nextafter(std::nextafter(per_m, 0.0F), 0.0F);
    at_most = Floats{} + std::nextafter(std::nextafter(per_m, kInfinity), kInfinity);
    const double farthest = 0x1p15;
#endif
    for (std::size_t a = 0; a < 3; ++a) {
      const double lowest = fan.lowest[a], end = fan.highest[a] + 1.0;
      if (lowest != static_cast<double>(fan.window_lowest[a])) return;  // cut by the lattice
      if (!(end > lowest && end - lowest <= 1 << kBitsOfNumber && lowest > -farthest && end < farthest)) return;
      first[a] = Numbers{} + std::bit_cast<std::uint32_t>(kWholeFloat + static_cast<float>(lowest));
      count[a] = Numbers{} + static_cast<std::uint32_t>(end - lowest);
    }
    is_usable = true;
  }
  bool is_usable = false;  ///< whether floats can tell these cells, and they have such numbers
  /// Floats on both sides of cells_per_m, next to it or both the same; where products are rounded, the second ones from
  /// the float nearest to it.
  Floats at_least, at_most;
  std::array<Numbers, 3> first, count;  ///< cells in the window, from this sum of the lowest and kWholeFloat on
};

/// Some of kFloats lanes.
#ifdef PINGVOX_AVX512
using SomeNumbers = __mmask16;
constexpr SomeNumbers kAllNumbers = 0xFFFF;
inline void keep_below(const Numbers& end, const Numbers& numbers, SomeNumbers& some) {
  some = _mm512_mask_cmplt_epu32_mask(some, reinterpret_cast<__m512i>(numbers), reinterpret_cast<__m512i>(end));
}
inline void keep_different(const Numbers& from, const Numbers& numbers, SomeNumbers& some) {
  some = _mm512_mask_cmpneq_epu32_mask(some, reinterpret_cast<__m512i>(numbers), reinterpret_cast<__m512i>(from));
}
inline void fill_others(SomeNumbers some, Numbers& numbers) {
  const __m512i all_bits = _mm512_set1_epi32(-1);
  numbers = reinterpret_cast<Numbers>(_mm512_mask_mov_epi32(all_bits, some, reinterpret_cast<__m512i>(numbers)));
}
inline std::uint32_t bits_of(SomeNumbers some) {
  return some;
}
inline bool is_any(const Numbers& bits) {
  return _mm512_test_epi32_mask(reinterpret_cast<__m512i>(bits), reinterpret_cast<__m512i>(bits)) != 0;
}
#else
using SomeNumbers = Numbers;  // true is -1
constexpr SomeNumbers kAllNumbers = Numbers{} - 1U;
inline void keep_below(const Numbers& end, const Numbers& numbers, SomeNumbers& some) {
  some &= reinterpret_cast<Numbers>(numbers < end);
}
inline void keep_different(const Numbers& from, const Numbers& numbers, SomeNumbers& some) {
  some &= reinterpret_cast<Numbers>(numbers != from);
}
inline void fill_others(const SomeNumbers& some, Numbers& numbers) {
  numbers |= ~some;
}
#ifdef PINGVOX_AVX2
inline std::uint32_t bits_of(const SomeNumbers& some) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(some)));
}
#else
inline std::uint32_t bits_of(const SomeNumbers& some) {
  std::uint32_t bits = 0;
  for (std::size_t l = 0; l < kFloats; ++l) bits |= (some[l] & 1U) << l;
  return bits;
}
#endif
inline bool is_any(const Numbers& bits) {
  return bits_of(reinterpret_cast<Numbers>(bits != 0U)) != 0;
}
#endif

/// Stores some numbers, one after the other, where there is room for all of them. @return how many
inline std::size_t store_some(const SomeNumbers& some, const Numbers& numbers, std::byte* to) {
#ifdef PINGVOX_AVX512
  _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(some, reinterpret_cast<__m512i>(numbers)));
  return static_cast<std::size_t>(__builtin_popcount(some));
#else
  std::size_t count = 0;
  for (std::uint32_t left = bits_of(some); left != 0; left &= left - 1) {
    const std::uint32_t number = numbers[std::countr_zero(left)];
    std::memcpy(to + count++ * sizeof number, &number, sizeof number);
  }
  return count;
#endif
}

/// Numbers of cells; those of points outside mean nothing.
struct CellsOfFloats {
  Numbers number{};
  SomeNumbers is_inside = kAllNumbers;
};

/// Largest whole numbers that are not larger than products, as bits of their sum with kWholeFloat.
inline void floor_of_product(const Floats& one, const Floats& other, Numbers& bits) {
#ifdef PINGVOX_AVX512
  constexpr int kDown = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
  bits = reinterpret_cast<Numbers>(_mm512_fmadd_round_ps(one, other, Floats{} + kWholeFloat, kDown));
#else
  const Floats product = one * other, near = product + kWholeFloat;
  bits = reinterpret_cast<Numbers>(near) + reinterpret_cast<Numbers>(near - kWholeFloat > product);  // true is -1
#endif
}

/// Finds cells in single precision: twice, with floats on both sides of cells_per_m, as the exact product lies between
/// theirs; where both cells are the same, points lie there.
/// Where products are rounded, one that is a little less than a whole number may become it: of positive numbers with
/// at_least, of negative ones with at_most. The second float on that side is less by more than what is rounded.
/// With AVX-512 nothing is rounded but the sum with a whole number, and that down: the cells are exact with either
/// scale. Points of which both are the same lie there with cells_per_m as a double, too: should that product be rounded
/// up to a whole number, then by less than what the larger neighbour (of negative numbers the smaller one) adds, which
/// comes as far.
/// @return whether both are the same for all points
inline bool find_by_floats(const FloatFan& fan, const float* points_m, CellsOfFloats& found) {
  std::array<Floats, 3> at_m;
  load_each<Signed>(points_m, at_m);
  Numbers different{};
  for (std::size_t a = 0; a < 3; ++a) {
    Numbers one, other;
    floor_of_product(at_m[a], fan.at_least, one);
    floor_of_product(at_m[a], fan.at_most, other);
    different |= one ^ other;
    // What is no number, or too large, is far from any cell of the window.
    const Numbers cell = one - fan.first[a];
    found.number |= cell << (kBitsOfNumber * static_cast<int>(a));
    keep_below(fan.count[a], cell, found.is_inside);
  }
  return !is_any(different);
}

inline void find_by_doubles(const FanLanes& fan, const float* points_m, CellsOfFloats& found) {
  std::array<HalfNumbers, 2> numbers, is_inside;
  for (std::size_t half = 0; half < 2; ++half) {
    PointLanes points;
    load_in(fan, points_m + half * 3 * kLanes, points);
    Words number;
    number_cells<kBitsOfNumber>(fan, points, number);
    numbers[half] = __builtin_convertvector(number, HalfNumbers);
    is_inside[half] = __builtin_convertvector(points.is_inside, HalfNumbers);
  }
  std::memcpy(&found.number, numbers.data(), sizeof found.number);
  Numbers inside;
  std::memcpy(&inside, is_inside.data(), sizeof inside);
  found.is_inside = kAllNumbers;
  keep_different(Numbers{}, inside, found.is_inside);
}

/// spread_bits for each lane. REQUIRES up to kBitsOfNumber bits
inline void spread(Numbers& numbers) {
  numbers = (numbers | numbers << 16) & 0x30000FF;
  numbers = (numbers | numbers << 8) & 0x300F00F;
  numbers = (numbers | numbers << 4) & 0x30C30C3;
  numbers = (numbers | numbers << 2) & 0x9249249;
}

/// CellsInARow for floats.
class NumbersInARow {
 public:
  explicit NumbersInARow(std::uint64_t* to) : to_(reinterpret_cast<std::byte*>(to)) {}

  /// Takes in the cells of kFloats points, where there is room for kLanes.
  void add(const CellsOfFloats& found) {
    Numbers number = found.number, before, one_back;
    fill_others(found.is_inside, number);
    for (std::size_t l = 0; l < kFloats; ++l) one_back[l] = static_cast<std::uint32_t>(kFloats - 1 + l);
    pick(last_, number, one_back, before);
    SomeNumbers others = found.is_inside;
    keep_different(before, number, others);
    count_ += store_some(others, number, to_ + count_ * sizeof(std::uint32_t));
    last_ = number;
  }

  /// Makes places of them (numbers of cells in the window). @return how many. To be called last.
  std::size_t finish() {
    // A place takes twice the room of a number: from the last one on, each is read before something is written there.
    for (std::size_t left = (count_ + kFloats - 1) / kFloats; left-- > 0;) {
      Numbers numbers, narrow{};
      std::memcpy(&numbers, to_ + left * sizeof numbers, sizeof numbers);
      for (std::size_t a = 0; a < 3; ++a) {
        Numbers cell = (numbers >> (kBitsOfNumber * static_cast<int>(a))) & ((1U << kBitsOfNumber) - 1);
        spread(cell);
        narrow |= cell << static_cast<int>(a);
      }
      std::array<HalfNumbers, 2> halves;
      std::memcpy(halves.data(), &narrow, sizeof narrow);
      std::array<Words, 2> places;
      for (std::size_t half = 0; half < 2; ++half) places[half] = __builtin_convertvector(halves[half], Words);
      std::memcpy(to_ + left * sizeof places, places.data(), sizeof places);
    }
    return count_;
  }

 private:
  std::byte* to_;
  std::size_t count_ = 0;
  Numbers last_ = Numbers{} - 1U;
};

inline std::size_t find_in_floats(const RayFan& fan, const FloatFan& float_fan,
                                  std::span<const Eigen::Vector3f> points_m, std::uint64_t* places,
                                  std::vector<std::uint32_t>& outside) {
  const FanLanes fan_lanes(fan);
  NumbersInARow cells(places);
  for_each_lanes<kFloats>(points_m, [&](std::size_t first, const float* some_m) {
    CellsOfFloats found;
    if (!find_by_floats(float_fan, some_m, found)) find_by_doubles(fan_lanes, some_m, found);
    cells.add(found);
    const std::uint32_t is_inside = bits_of(found.is_inside);
    if (is_inside == bits_of(kAllNumbers)) return;  // as most often
    for (std::size_t l = 0; l < std::min(kFloats, points_m.size() - first); ++l) {
      if ((is_inside >> l & 1) == 0) outside.push_back(static_cast<std::uint32_t>(first + l));
    }
  });
  return cells.finish();
}

template <class Point>
inline std::size_t find(const RayFan& fan, std::span<const Point> points_m, std::uint64_t* places,
                        std::vector<std::uint32_t>& outside) {
  if constexpr (std::is_same_v<Point, Eigen::Vector3f>) {
    const FloatFan float_fan(fan);
    if (float_fan.is_usable) return find_in_floats(fan, float_fan, points_m, places, outside);
  }
  return find_in_doubles(fan, points_m, places, outside);
}
