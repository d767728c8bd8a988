// The loops over lanes, included by ray_lanes.cpp once for each kind of machine: there is no guard, and what they
// use stands there before them.

#include "map/kernels/lanes_loops.hpp"

/// Added without minding the sign: a sum that does not fit wraps around.
inline Words sum_of(const Words& one, const Words& other) {
  return reinterpret_cast<Words>(reinterpret_cast<UnsignedWords>(one) + reinterpret_cast<UnsignedWords>(other));
}

/// kLanes items from `first` on; of fewer that are left the last one again and again.
template <class Item>
inline const Item* some_from(std::span<const Item> items, std::size_t first, std::array<Item, kLanes>& padded) {
  if (items.size() - first >= kLanes) return items.data() + first;
  for (std::size_t l = 0; l < kLanes; ++l) padded[l] = items[std::min(first + l, items.size() - 1)];
  return padded.data();
}

struct Prepared {
  std::array<Words, 3> next, apart;
  Words left{}, end{}, ahead{}, is_ready{};
  // Along the axes so far: the last face that is crossed, and the first one beyond an end.
  Words last_crossing = Words{} + std::numeric_limits<std::int64_t>::min(), beyond_end = Words{} + kNever;
};

/// What FaceCrossings counts along one axis, for rays between these coordinates [cells].
/// @param first, last  get their cells
inline void prepare_axis(const Doubles& from, const Doubles& to, std::size_t a, Prepared& out, Words& first,
                         Words& last) {
  floor_of(from, first);
  floor_of(to, last);
  const Doubles first_cell = __builtin_convertvector(first, Doubles);
  const Words is_ahead = last >= first;
  const Words faces = is_ahead ? last - first : first - last;
  const Words some = faces > 0, several = faces > 1;
  const Doubles way = to - from;
  const Doubles length = some ? (way < 0.0 ? -way : way) : Doubles{} + 1.0;
  const Doubles to_first = (is_ahead ? first_cell + 1.0 - from : from - first_cell) / length * kUnits;
  const Doubles between = 1.0 / length * kUnits;
  const Words next = __builtin_convertvector(some ? to_first : Doubles{}, Words);
  const Words apart = __builtin_convertvector(several ? between : Doubles{}, Words);
  out.next[a] = some ? next : Words{} + kNever;
  out.apart[a] = several ? apart : (some ? kNever - next : Words{});
  // What does not fit becomes negative, and the ray is not taken.
  const Words last_crossing = next + (faces - 1) * apart;
  const Words beyond = sum_of(last_crossing, apart);
  out.last_crossing = (some & (last_crossing > out.last_crossing)) ? last_crossing : out.last_crossing;
  out.beyond_end = (several & (beyond < out.beyond_end)) ? beyond : out.beyond_end;
  out.left += faces;
  out.ahead |= (is_ahead & 1) << a;
}

/// Whether sums of these units give the order of faces that FaceCrossings gives.
inline void decide(const Words& inside, Prepared& out) {
  out.is_ready =
      inside & (out.beyond_end > out.last_crossing) & (out.left <= static_cast<std::int64_t>(FaceCrossings::kFewFaces));
}

/// Rows become columns: blocks of `Edge` rows and columns change places, then those of twice the size.
template <std::size_t Edge = 1>
inline void transpose(std::array<Words, kLanes>& square) {
  if constexpr (Edge < kLanes) {
    Words of_one{}, of_other{};
    for (std::size_t l = 0; l < kLanes; ++l) {
      of_one[l] = static_cast<std::int64_t>((l & Edge) != 0 ? kLanes + l - Edge : l);
      of_other[l] = static_cast<std::int64_t>((l & Edge) != 0 ? kLanes + l : l + Edge);
    }
    for (std::size_t i = 0; i < kLanes / 2; ++i) {
      const std::size_t row = i / Edge * 2 * Edge + i % Edge;
      const Words one = square[row], other = square[row + Edge];
      pick(one, other, of_one, square[row]);
      pick(one, other, of_other, square[row + Edge]);
    }
    transpose<2 * Edge>(square);
  }
}

/// ReadyRays as words, side by side: next faces, how far they are apart, faces left with ways ahead, ends.
constexpr std::size_t kCounts = 6, kWordsOfRay = 8;
static_assert(sizeof(ReadyRay) == kWordsOfRay * sizeof(std::int64_t) && kWordsOfRay % kLanes == 0);
constexpr int kLeftAt = std::endian::native == std::endian::little ? 0 : 32, kAheadAt = 32 - kLeftAt;
using RayWords = std::array<Words, kWordsOfRay>;

inline void words_of(const std::array<const ReadyRay*, kLanes>& rays, RayWords& words) {
  std::array<Words, kLanes> square;
  for (std::size_t first = 0; first < kWordsOfRay; first += kLanes) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      std::memcpy(&square[l], reinterpret_cast<const std::byte*>(rays[l]) + first * sizeof(std::int64_t),
                  sizeof square[l]);
    }
    transpose(square);
    for (std::size_t l = 0; l < kLanes; ++l) words[first + l] = square[l];
  }
}

inline void rays_of(const Prepared& some, std::array<ReadyRay, kLanes>& rays) {
  const RayWords words{some.next[0],
                       some.next[1],
                       some.next[2],
                       some.apart[0],
                       some.apart[1],
                       some.apart[2],
                       some.left << kLeftAt | some.ahead << kAheadAt,
                       some.end};
  std::array<Words, kLanes> square;
  for (std::size_t first = 0; first < kWordsOfRay; first += kLanes) {
    for (std::size_t l = 0; l < kLanes; ++l) square[l] = words[first + l];
    transpose(square);
    for (std::size_t l = 0; l < kLanes; ++l) {
      std::memcpy(reinterpret_cast<std::byte*>(&rays[l]) + first * sizeof(std::int64_t), &square[l], sizeof square[l]);
    }
  }
}

template <class Real>
inline void prepare_some(const FanLanes& fan, const Real* ends_m, Prepared& out) {
  PointLanes ends;
  load_in(fan, ends_m, ends);
  for (std::size_t a = 0; a < 3; ++a) {
    Words first, place;
    prepare_axis(fan.from[a], ends.at[a], a, out, first, place);
    place -= fan.window_lowest[a];
    spread(place);
    out.end |= place << a;
  }
  decide(ends.is_inside, out);
}

template <class Point>
inline void prepare(const RayFan& fan, std::span<const Point> ends_m, std::vector<ReadyRay>& ready,
                    std::vector<std::uint32_t>& others) {
  ready.resize(ends_m.size());
  std::size_t count = 0;
  const FanLanes fan_lanes(fan);
  for_each_lanes(ends_m, [&](std::size_t first, const auto* some_m) {
    Prepared some;
    prepare_some(fan_lanes, some_m, some);
    std::array<ReadyRay, kLanes> rays;
    rays_of(some, rays);
    for (std::size_t l = 0; l < std::min(kLanes, ends_m.size() - first); ++l) {
      ready[count] = rays[l];
      if (some.is_ready[l] != 0) {
        ++count;
      } else {
        others.push_back(static_cast<std::uint32_t>(first + l));
      }
    }
  });
  ready.resize(count);
}

inline void find_middles(const RayFan& fan, double resolution_m, std::span<const std::uint64_t> places,
                         std::span<Eigen::Vector3d> middles_m) {
  for (std::size_t first = 0; first < places.size(); first += kLanes) {
    std::array<std::uint64_t, kLanes> padded;
    Words place;
    std::memcpy(&place, some_from(places, first, padded), sizeof place);
    std::array<Doubles, 3> middle_m;
    for (std::size_t a = 0; a < 3; ++a) {
      Words cell = place >> a;
      gather_bits(cell);
      middle_m[a] = (__builtin_convertvector(cell + fan.window_lowest[a], Doubles) + 0.5) * resolution_m;
    }
    for (std::size_t l = 0; l < std::min(kLanes, places.size() - first); ++l) {
      middles_m[first + l] = {middle_m[0][l], middle_m[1][l], middle_m[2][l]};
    }
  }
}

/// axis_of_least for each lane: all bits set of the axis that is next, none of the others.
inline void choose_axes(const std::array<Words, 3>& next, std::array<Words, 3>& along) {
  const Words is_0_first = next[0] < next[1], is_1_second = next[1] < next[2];
  along[0] = is_0_first & (next[0] < next[2]);
#ifdef PINGVOX_AVX2
  // Said in C++, g++ makes three operations of each choice between something and nothing.
  const auto and_not = [](const Words& of, const Words& some, Words& left) {
    left = reinterpret_cast<Words>(_mm256_andnot_si256(reinterpret_cast<__m256i>(some), reinterpret_cast<__m256i>(of)));
  };
  and_not(is_1_second, is_0_first, along[1]);
  and_not(Words{} - 1, along[0] | along[1], along[2]);
#else
  along[1] = ~is_0_first & is_1_second;
  along[2] = ~(along[0] | along[1]);
#endif
}

/// Of some lanes the one, of the others the other. Both stay the same from step to step; so does what they differ in.
inline void choose(const Words& some, const Words& one, const Words& other, Words& chosen) {
#ifdef PINGVOX_AVX512
  chosen = some ? one : other;
#else
  chosen = other ^ (some & (one ^ other));  // two operations; choosing is three where there are no masks
#endif
}

/// Adds to some lanes, without minding the sign.
inline void add_where(const Words& some, const Words& more, Words& to) {
#ifdef PINGVOX_AVX512
  to = some ? sum_of(to, more) : to;
#else
  to = sum_of(to, some & more);
#endif
}

/// Adds a step of some lanes to an axis' bits of a place.
inline void step_where(const Words& some, const Words& step, const Words& bits, Words& place) {
#ifdef PINGVOX_AVX512
  const Words moved = (place + step) & bits;
  place = some ? moved : place;
#else
  place = (place + (some & step)) & bits;
#endif
}

/// The word of a cell's brick.
inline void word_of(const Words& place, Words& word) {
  word = reinterpret_cast<Words>(reinterpret_cast<UnsignedWords>(place) >> 6);
}

/// The bit of a cell in its brick.
inline void bit_of(const Words& place, Words& bit) {
#ifdef PINGVOX_AVX512
  // Turned, not shifted: that takes the lowest six bits of a place by itself.
  const __m512i one = _mm512_set1_epi64(1);
  bit = reinterpret_cast<Words>(_mm512_maskz_rolv_epi64(0xFF, one, reinterpret_cast<__m512i>(place)));
#else
  bit = (Words{} + 1) << (place & 63);
#endif
}

/// Up to kLanes rays side by side, and how many faces the shortest and the longest cross.
struct RayLanes {
  std::array<Words, 3> next{}, apart{}, is_ahead{};
  Words left{};
  std::int64_t shortest = 0, longest = 0;
};

/// @param order  rays by length, the longest first
inline void gather(std::span<const ReadyRay> rays, std::span<const std::uint32_t> order, RayLanes& to) {
  const ReadyRay none{};
  std::array<const ReadyRay*, kLanes> some;
  for (std::size_t l = 0; l < kLanes; ++l) some[l] = l < order.size() ? &rays[order[l]] : &none;
  RayWords words;
  words_of(some, words);
  for (std::size_t a = 0; a < 3; ++a) {
    to.next[a] = words[a];
    to.apart[a] = words[3 + a];
    to.is_ahead[a] = ((words[kCounts] >> (kAheadAt + static_cast<int>(a))) & 1) != 0;
  }
  to.left = (words[kCounts] >> kLeftAt) & 0xFFFFFFFF;
  to.shortest = order.size() == kLanes ? rays[order.back()].left : 0;
  to.longest = rays[order.front()].left;
}

/// step_of for each lane.
inline void choose_steps(std::uint64_t axis_bits, const Words& is_ahead, Words& step) {
  const auto ahead = static_cast<std::int64_t>(step_of(axis_bits, true)),
             back = static_cast<std::int64_t>(step_of(axis_bits, false));
  step = is_ahead ? Words{} + ahead : Words{} + back;
}

/// Where rays are in a window, face by face.
struct Steps {
  Steps(const RayLanes& rays, std::uint64_t start) : next(rays.next), apart(rays.apart) {
    for (std::size_t a = 0; a < 3; ++a) {
      choose_steps(kAxisBits[a], rays.is_ahead[a], step[a]);
      bits[a] = Words{} + static_cast<std::int64_t>(kAxisBits[a]);
      place[a] = (Words{} + static_cast<std::int64_t>(start)) & bits[a];
    }
  }
  void find(Words& at) const { at = place[0] | place[1] | place[2]; }
  void cross() {
    std::array<Words, 3> along;
    choose_axes(next, along);
    for (std::size_t a = 0; a < 3; ++a) {
      add_where(along[a], apart[a], next[a]);  // those of rays that have ended mean nothing
      step_where(along[a], step[a], bits[a], place[a]);
    }
  }
  std::array<Words, 3> next, apart, step, bits, place;
};

/// The same in a layer, for rays that cross no face along z: of two axes the lesser is told by the sign of a
/// difference.
struct FlatSteps {
  FlatSteps(const RayLanes& rays, std::uint64_t start)
      : x_before_y(rays.next[0] - rays.next[1]), apart_x(rays.apart[0]), apart_y(-rays.apart[1]) {
    for (std::size_t a = 0; a < 2; ++a) {
      choose_steps(kLayerBits[a], rays.is_ahead[a], step[a]);
      bits[a] = Words{} + static_cast<std::int64_t>(kLayerBits[a]);
    }
    place = Words{} + static_cast<std::int64_t>(start);
  }
  void find(Words& at) const { at = place; }
  void cross() {
    const Words is_x = x_before_y < 0;
    Words apart, along, by;
    choose(is_x, apart_x, apart_y, apart);
    choose(is_x, bits[0], bits[1], along);
    choose(is_x, step[0], step[1], by);
    x_before_y = sum_of(x_before_y, apart);
    const Words moved = (place & along) + by;
    place = (moved & along) | (place & ~along);
  }
  Words x_before_y, apart_x, apart_y;
  std::array<Words, 2> step, bits;
  Words place;
};

/// Walks rays of about the same length, face by face.
/// @param to  where set_marks sets marks
template <class Steps, class To>
inline void mark_some(const RayLanes& rays, std::uint64_t start, To& to, MarksToSet& to_set) {
  Steps steps(rays, start);
  const Words begin = Words{} + static_cast<std::int64_t>(start);
  Words word, marks{};
  word_of(begin, word);
  std::size_t count = to_set.count;
  const auto enter = [&](const Words& at) {
    Words entered, cell;
    word_of(at, entered);
    bit_of(at, cell);
    Some moved_on;
    find_different(word, entered, moved_on);
    store_some(moved_on, word, to_set.word.data() + count);
    count += store_some(moved_on, marks, to_set.marks.data() + count);
    clear_some(moved_on, marks);
    marks |= cell;
    word = entered;
    if (count > MarksToSet::kRoom - 2 * kLanes) {
      set_marks(to_set, count, to);
      count = 0;
    }
  };
  std::int64_t n = 0;
  Words at;
  for (; n < rays.shortest; ++n) {
    steps.find(at);
    enter(at);
    steps.cross();
  }
  for (; n < rays.longest; ++n) {
    // A ray that has ended marks where it began once more.
    steps.find(at);
    enter(rays.left > n ? at : begin);
    steps.cross();
  }
  Some all;
  find_different(begin, ~begin, all);
  store_some(all, word, to_set.word.data() + count);
  to_set.count = count + store_some(all, marks, to_set.marks.data() + count);
}

template <class Steps, class To>
inline void mark_by_length(std::span<const ReadyRay> rays, std::uint64_t start, To& to) {
  const ByLength by_length(rays);
  std::span<const std::uint32_t> order = by_length.order();
  MarksToSet to_set;
  while (!order.empty()) {
    RayLanes lanes;
    const std::size_t some = std::min(kLanes, order.size());
    gather(rays, order.first(some), lanes);
    mark_some<Steps>(lanes, start, to, to_set);
    order = order.subspan(some);
  }
  set_marks(to_set, to_set.count, to);
}

inline void mark_all(std::span<const ReadyRay> rays, std::uint64_t start, MissesIn where, ScanWindow& window) {
  if (where == MissesIn::kMaskOrLayer && are_flat(rays, window)) {
    const Layer layer{window.layer()};
    mark_by_length<FlatSteps>(rays, without_z(start), layer);
    window.layer_z() = start & kAxisBits[2];
  } else {
    mark_by_length<Steps>(rays, start, window);
  }
}

#include "map/kernels/find_cells_loops.hpp"
#include "map/kernels/ray_keys_loops.hpp"
