// The loops over the values of a brick, included by brick.cpp once for each kind of machine (see ray_lanes_loops.hpp).

#include "map/kernels/doubles_loops.hpp"

/// As many values as the machine's vectors hold.
constexpr std::size_t kValues = 2 * kLanes;
using Values = float __attribute__((vector_size(kValues * sizeof(float))));
using Masks = std::int32_t __attribute__((vector_size(kValues * sizeof(float))));
constexpr std::uint64_t kSome = (std::uint64_t{1} << kValues) - 1;

inline Values values_at(BrickView brick, std::size_t first) {
  Values values;
  std::memcpy(&values, brick.value.data() + first, sizeof values);
  return values;
}

/// All bits of a lane set where a bit of `cells`, shifted down to the first of four, is set.
inline Masks lanes_of(std::uint64_t cells) {
  Masks bits{};
  for (std::size_t i = 0; i < kValues; ++i) bits[i] = std::int32_t{1} << i;
  return (bits & static_cast<std::int32_t>(cells & kSome)) != 0;
}

inline bool any_of(Masks lanes) {
  std::array<std::uint64_t, kValues / 2> words;
  std::memcpy(words.data(), &lanes, sizeof lanes);
  std::uint64_t any = 0;
  for (const std::uint64_t word : words) any |= word;
  return any != 0;
}

/// for each cell of `cells`: value = updated_by(value, evidence, clamp). REQUIRES evidence != 0 and unknown cells to be
/// 0.
/// @return whether a value changed
inline bool add_alike(BrickRef brick, std::uint64_t cells, float evidence, const Clamp& clamp) {
  const float lowest = clamp.lowest.value(), highest = clamp.highest.value();
  const bool is_hit = evidence > 0.0F;
  Masks changed{};
  for (std::size_t first = 0; first < 64; first += kValues) {
    const std::uint64_t some = cells >> first;
    if ((some & kSome) == 0) continue;
    const Values before = values_at(brick, first);
    const Values sum = before + evidence;
    const Values from_below = sum < lowest ? Values{} + lowest : sum;
    const Values clamped = from_below > highest ? Values{} + highest : from_below;
    // What is at the clamp that the evidence leads to, or was set beyond it, stays.
    const Masks moves = is_hit ? before < highest : before > lowest;
    const Values after = (lanes_of(some) & moves) != 0 ? clamped : before;
    changed |= after != before;
    std::memcpy(brick.value.data() + first, &after, sizeof after);
  }
  return any_of(changed);
}

/// The highest lane: by halves, as lanes one after the other would wait for each other.
template <std::size_t Half = kValues / 2>
inline float most_of(const Values& values) {
  if constexpr (Half == 0) {
    return values[0];
  } else {
    Masks places{};
    for (std::size_t i = 0; i < kValues; ++i) places[i] = static_cast<std::int32_t>(i ^ Half);
    Values others;
    pick(values, values, places, others);
    return most_of<Half / 2>(values < others ? others : values);
  }
}

/// for each known cell: highest = max(highest, value)
inline float highest_of(BrickView brick) {
  Values highest = Values{} + std::numeric_limits<float>::lowest();
  for (std::size_t first = 0; first < 64; first += kValues) {
    if ((brick.known >> first & kSome) == 0) continue;  // as half of each brick in a flat map
    const Values value = values_at(brick, first);
    highest = (lanes_of(brick.known >> first) & (value > highest)) != 0 ? value : highest;
  }
  return most_of(highest);
}

/// for each cell: value == value[0]
inline bool are_equal(BrickView brick) {
  Masks different{};
  for (std::size_t first = 0; first < 64; first += kValues) different |= values_at(brick, first) != brick.value[0];
  return !any_of(different);
}

/// for each cell, known or not: its bit set where value >= threshold
inline std::uint64_t cells_from(BrickView brick, float threshold) {
  std::uint64_t cells = 0;
#ifdef PINGVOX_AVX512
  for (std::size_t first = 0; first < 64; first += kValues) {
    const auto values = reinterpret_cast<__m512>(values_at(brick, first));
    cells |= std::uint64_t{_mm512_cmp_ps_mask(values, _mm512_set1_ps(threshold), _CMP_GE_OQ)} << first;
  }
#else
  for (std::size_t half = 0; half < 64; half += 32) {
    Masks some{}, bits{};
    for (std::size_t i = 0; i < kValues; ++i) bits[i] = std::int32_t{1} << i;
    for (std::size_t first = 0; first < 32; first += kValues) {
      some |= (values_at(brick, half + first) >= threshold) & bits;
      bits <<= kValues;
    }
    std::uint32_t all = 0;
    for (std::size_t i = 0; i < kValues; ++i) all |= static_cast<std::uint32_t>(some[i]);
    cells |= std::uint64_t{all} << half;
  }
#endif
  return cells;
}
