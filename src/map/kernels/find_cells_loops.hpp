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

#ifdef PINGVOX_AVX512

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
    const bool is_less = static_cast<double>(per_m) < fan.cells_per_m;
    const bool is_more = static_cast<double>(per_m) > fan.cells_per_m;
    at_least = Floats{} + (is_more ? std::nextafter(per_m, 0.0F) : per_m);
    at_most = Floats{} + (is_less ? std::nextafter(per_m, std::numeric_limits<float>::infinity()) : per_m);
    // Products lie farther apart the larger they are; beyond this they would not name the same cell often enough.
    const double farthest = is_less || is_more ? 0x1p17 : 0x1p21;
    for (std::size_t a = 0; a < 3; ++a) {
      const double lowest = fan.lowest[a], end = fan.highest[a] + 1.0;
      if (lowest != static_cast<double>(fan.window_lowest[a])) return;  // cut by the lattice
      if (!(end > lowest && end - lowest <= 1 << kBitsOfNumber && lowest > -farthest && end < farthest)) return;
      first[a] = Numbers{} + std::bit_cast<std::uint32_t>(kWholeFloat + static_cast<float>(lowest));
      count[a] = Numbers{} + static_cast<std::uint32_t>(end - lowest);
    }
    is_usable = true;
  }
  bool is_usable = false;               ///< whether floats can tell these cells, and they have such numbers
  Floats at_least, at_most;             ///< floats next to cells_per_m, on both sides of it or both the same
  std::array<Numbers, 3> first, count;  ///< cells in the window, from this sum of the lowest and kWholeFloat on
};

/// Numbers of cells; those of points outside mean nothing.
struct CellsOfFloats {
  Numbers number{};
  __mmask16 is_inside = 0xFFFF;
};

/// Finds cells in single precision. Nothing is rounded but the sum of an exact product and a whole number, and that
/// down to a whole number: these are the cells where points lie, exactly, when the scale is either neighbour of
/// cells_per_m. Where both are the same, points lie there with cells_per_m as well, and with a product of doubles:
/// should that be rounded up to a whole number, then by less than what the larger neighbour (of negative numbers the
/// smaller one) adds, which comes as far.
/// @return whether both are the same for all points
inline bool find_by_floats(const FloatFan& fan, const float* points_m, CellsOfFloats& found) {
  constexpr int kDown = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
  std::array<Floats, 3> at_m;
  load_each<Signed>(points_m, at_m);
  const Floats whole = Floats{} + kWholeFloat;
  Numbers different{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto one = reinterpret_cast<Numbers>(_mm512_fmadd_round_ps(at_m[a], fan.at_least, whole, kDown));
    const auto other = reinterpret_cast<Numbers>(_mm512_fmadd_round_ps(at_m[a], fan.at_most, whole, kDown));
    different |= one ^ other;
    // What is no number, or too large, is far from any cell of the window.
    const Numbers cell = one - fan.first[a];
    found.number |= cell << (kBitsOfNumber * static_cast<int>(a));
    found.is_inside = _mm512_mask_cmplt_epu32_mask(found.is_inside, reinterpret_cast<__m512i>(cell),
                                                   reinterpret_cast<__m512i>(fan.count[a]));
  }
  const auto bits = reinterpret_cast<__m512i>(different);
  return _mm512_test_epi32_mask(bits, bits) == 0;
}

inline void find_by_doubles(const FanLanes& fan, const float* points_m, CellsOfFloats& found) {
  std::array<HalfNumbers, 2> halves;
  unsigned is_inside = 0;
  for (std::size_t half = 0; half < 2; ++half) {
    PointLanes points;
    load_in(fan, points_m + half * 3 * kLanes, points);
    Words numbers;
    number_cells<kBitsOfNumber>(fan, points, numbers);
    halves[half] = __builtin_convertvector(numbers, HalfNumbers);
    is_inside |= unsigned{_mm512_movepi64_mask(reinterpret_cast<__m512i>(points.is_inside))} << (half * kLanes);
  }
  std::memcpy(&found.number, halves.data(), sizeof found.number);
  found.is_inside = static_cast<__mmask16>(is_inside);
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
    const __m512i outside = _mm512_set1_epi32(-1);
    const Numbers number = reinterpret_cast<Numbers>(
        _mm512_mask_mov_epi32(outside, found.is_inside, reinterpret_cast<__m512i>(found.number)));
    Numbers before, one_back;
    for (std::size_t l = 0; l < kFloats; ++l) one_back[l] = static_cast<std::uint32_t>(kFloats - 1 + l);
    pick(last_, number, one_back, before);
    const __mmask16 others = _mm512_mask_cmpneq_epi32_mask(found.is_inside, reinterpret_cast<__m512i>(number),
                                                           reinterpret_cast<__m512i>(before));
    const __m512i some = _mm512_maskz_compress_epi32(others, reinterpret_cast<__m512i>(number));
    _mm512_storeu_si512(to_ + count_ * sizeof(std::uint32_t), some);
    count_ += static_cast<std::size_t>(__builtin_popcount(others));
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
    if (found.is_inside == 0xFFFF) return;  // as most often
    for (std::size_t l = 0; l < std::min(kFloats, points_m.size() - first); ++l) {
      if ((found.is_inside >> l & 1) == 0) outside.push_back(static_cast<std::uint32_t>(first + l));
    }
  });
  return cells.finish();
}

#endif

template <class Point>
inline std::size_t find(const RayFan& fan, std::span<const Point> points_m, std::uint64_t* places,
                        std::vector<std::uint32_t>& outside) {
#ifdef PINGVOX_AVX512
  if constexpr (std::is_same_v<Point, Eigen::Vector3f>) {
    const FloatFan float_fan(fan);
    if (float_fan.is_usable) return find_in_floats(fan, float_fan, points_m, places, outside);
  }
#endif
  return find_in_doubles(fan, points_m, places, outside);
}
