// The loops over lanes, included by ray_lanes.cpp once for each kind of machine: there is no guard, and what they
// use stands there before them. (A function can only be made for another machine where it is compiled, and templates
// and inline functions would be shared between all.)

/// As many numbers as the machine's vectors hold.
using Doubles = double __attribute__((vector_size(kLanes * sizeof(double))));
using Words = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

/// Adds without minding the sign: a sum that does not fit wraps around.
inline void add_wrapping(Words& to, const Words& what) {
  using Unsigned = std::uint64_t __attribute__((vector_size(kLanes * sizeof(std::uint64_t))));
  to = reinterpret_cast<Words>(reinterpret_cast<Unsigned>(to) + reinterpret_cast<Unsigned>(what));
}

/// kLanes items from `first` on; of fewer that are left the last one again and again.
template <class Item>
inline const Item* some_from(std::span<const Item> items, std::size_t first, std::array<Item, kLanes>& padded) {
  if (items.size() - first >= kLanes) return items.data() + first;
  for (std::size_t l = 0; l < kLanes; ++l) padded[l] = items[std::min(first + l, items.size() - 1)];
  return padded.data();
}

/// Coordinate `axis` of kLanes points, in cells.
inline void load(const Eigen::Vector3d* points_m, std::size_t axis, double cells_per_m, Doubles& cells) {
  const auto a = static_cast<Eigen::Index>(axis);
  Doubles coordinates{};
  for (std::size_t l = 0; l < kLanes; ++l) coordinates[l] = points_m[l][a];
  cells = coordinates * cells_per_m;
}

/// Largest whole numbers that are not larger. REQUIRES numbers below 2^53.
inline void floor_of(const Doubles& numbers, Words& whole) {
  whole = __builtin_convertvector(numbers, Words);
  whole += __builtin_convertvector(whole, Doubles) > numbers;  // true is -1
}

inline void spread(Words& words) {
  // spread_bits, which holds for all lanes alike.
  words = (words | words << 32) & 0x1F00000000FFFF;
  words = (words | words << 16) & 0x1F0000FF0000FF;
  words = (words | words << 8) & 0x100F00F00F00F00F;
  words = (words | words << 4) & 0x10C30C30C30C30C3;
  words = (words | words << 2) & 0x1249249249249249;
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
  Words beyond = last_crossing;
  add_wrapping(beyond, apart);
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

inline ReadyRay ray_of(const Prepared& some, std::size_t lane) {
  return {{some.next[0][lane], some.next[1][lane], some.next[2][lane]},
          {some.apart[0][lane], some.apart[1][lane], some.apart[2][lane]},
          static_cast<std::uint32_t>(some.left[lane]),
          static_cast<std::uint32_t>(some.ahead[lane]),
          static_cast<std::uint64_t>(some.end[lane])};
}

inline void prepare_some(const RayFan& fan, const Eigen::Vector3d* ends_m, Prepared& out) {
  std::array<Doubles, 3> to;
  Words inside = Words{} - 1;
  for (std::size_t a = 0; a < 3; ++a) {
    load(ends_m, a, fan.cells_per_m, to[a]);
    inside &= (to[a] >= fan.lowest[a]) & (to[a] < fan.highest[a] + 1.0);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const Doubles from = Doubles{} + fan.from[static_cast<Eigen::Index>(a)];
    Words first, place;
    prepare_axis(from, inside ? to[a] : from, a, out, first, place);
    place -= fan.window_lowest[a];
    spread(place);
    out.end |= place << a;
  }
  decide(inside, out);
}

inline void prepare(const RayFan& fan, std::span<const Eigen::Vector3d> ends_m, std::vector<ReadyRay>& ready,
                    std::vector<std::uint32_t>& others) {
  ready.resize(ends_m.size());
  std::size_t count = 0;
  for (std::size_t first = 0; first < ends_m.size(); first += kLanes) {
    const std::size_t lanes = std::min(kLanes, ends_m.size() - first);
    std::array<Eigen::Vector3d, kLanes> padded;
    Prepared some;
    prepare_some(fan, some_from(ends_m, first, padded), some);
    for (std::size_t l = 0; l < lanes; ++l) {
      if (some.is_ready[l] == 0) {
        others.push_back(static_cast<std::uint32_t>(first + l));
        continue;
      }
      ready[count++] = ray_of(some, l);
    }
  }
  ready.resize(count);
}

inline void find(const RayFan& fan, std::span<const Eigen::Vector3d> points_m, std::span<std::uint64_t> places) {
  for (std::size_t first = 0; first < points_m.size(); first += kLanes) {
    const std::size_t lanes = std::min(kLanes, points_m.size() - first);
    std::array<Eigen::Vector3d, kLanes> padded;
    Words inside = Words{} - 1, place = Words{};
    for (std::size_t a = 0; a < 3; ++a) {
      Doubles at;
      load(some_from(points_m, first, padded), a, fan.cells_per_m, at);
      const Words fits = (at >= fan.lowest[a]) & (at < fan.highest[a] + 1.0);
      inside &= fits;
      Words cell;
      floor_of(fits ? at : Doubles{} + fan.lowest[a], cell);
      cell -= fan.window_lowest[a];
      spread(cell);
      place |= cell << a;
    }
    place |= ~inside;  // kNowhere: all bits
    if (lanes == kLanes) {
      std::memcpy(places.data() + first, &place, sizeof place);
    } else {
      for (std::size_t l = 0; l < lanes; ++l) places[first + l] = static_cast<std::uint64_t>(place[l]);
    }
  }
}

/// axis_of_least for each lane: all bits set of the axis that is next, none of the others.
inline void choose_axes(const std::array<Words, 3>& next, std::array<Words, 3>& along) {
  const Words is_0_first = next[0] < next[1];
  along[0] = is_0_first & (next[0] < next[2]);
  along[1] = ~is_0_first & (next[1] < next[2]);
  along[2] = ~(along[0] | along[1]);
}

/// Walks up to kLanes rays of about the same length, face by face.
inline void mark_some(std::span<const ReadyRay> rays, std::span<const std::uint32_t> order, std::uint64_t start,
                      std::uint64_t* missed, std::uint8_t* touched) {
  std::array<Words, 3> next{}, apart{}, step{}, place{};
  Words left{};
  for (std::size_t l = 0; l < order.size(); ++l) {
    const ReadyRay& ray = rays[order[l]];
    for (std::size_t a = 0; a < 3; ++a) {
      next[a][l] = ray.next[a];
      apart[a][l] = ray.apart[a];
      step[a][l] = static_cast<std::int64_t>(step_of(a, ((ray.ahead >> a) & 1U) != 0));
    }
    left[l] = ray.left;
  }
  const Words begin = Words{} + static_cast<std::int64_t>(start);
  std::array<Words, 3> bits;
  for (std::size_t a = 0; a < 3; ++a) {
    bits[a] = Words{} + static_cast<std::int64_t>(kAxisBits[a]);
    place[a] = begin & bits[a];
  }
  std::array<Words, 3> along{};
  std::array<std::uint64_t, kLanes> places;
  for (std::int64_t most = rays[order.front()].left; most > 0; --most) {
    // A ray that has ended marks where it began once more.
    const Words at = left > 0 ? place[0] | place[1] | place[2] : begin;
    std::memcpy(places.data(), &at, sizeof at);
    left -= 1;
    choose_axes(next, along);
    for (std::size_t a = 0; a < 3; ++a) {
      add_wrapping(next[a], along[a] & apart[a]);  // those of rays that have ended mean nothing
      place[a] = (place[a] + (along[a] & step[a])) & bits[a];
    }
    for (const std::uint64_t of_one : places) mark_place(of_one, missed, touched);
  }
}

inline void mark_all(std::span<const ReadyRay> rays, std::uint64_t start, ScanWindow& window) {
  const ByLength by_length(rays);
  std::span<const std::uint32_t> order = by_length.order();
  while (!order.empty()) {
    const std::size_t lanes = std::min(kLanes, order.size());
    mark_some(rays, order.first(lanes), start, window.missed(), window.touched());
    order = order.subspan(lanes);
  }
}
