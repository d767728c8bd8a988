// Numbers side by side, included before the loops over lanes once for each kind of machine: there is no guard, and
// kLanes stands there before. (A function can only be made for another machine where it is compiled, and templates and
// inline functions would be shared between all.)

/// As many numbers as the machine's vectors hold.
using Doubles = double __attribute__((vector_size(kLanes * sizeof(double))));
using Words = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));
/// For sums that may wrap around, and shifts that bring in no sign.
using UnsignedWords = std::uint64_t __attribute__((vector_size(kLanes * sizeof(std::uint64_t))));

/// Adding this leaves no room for a fraction. REQUIRES numbers below 2^51.
constexpr double kWhole = 0x1.8p52;

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

inline void load(const double* from, Doubles& numbers) {
  std::memcpy(&numbers, from, sizeof numbers);
}

/// Largest whole numbers that are not larger, as doubles: not each machine makes integers of them side by side.
inline void floor_of(const Doubles& numbers, Doubles& whole) {
  const Doubles near = (numbers + kWhole) - kWhole;
  whole = near > numbers ? near - 1.0 : near;
}
inline void ceil_of(const Doubles& numbers, Doubles& whole) {
  const Doubles near = (numbers + kWhole) - kWhole;
  whole = near < numbers ? near + 1.0 : near;
}

/// Whole numbers in the lowest 51 bits, as integers when those of kWhole are taken off.
inline void bits_of(const Doubles& whole, Words& bits) {
  bits = reinterpret_cast<Words>(whole + kWhole);
}
