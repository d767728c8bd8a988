// The loops over lanes, included by ray_lanes.cpp once for each kind of machine: there is no guard, and what they
// use stands there before them.

#include "map/kernels/lanes_loops.hpp"

/// Added without minding the sign: a sum that does not fit wraps around.
inline Words sum_of(const Words& one, const Words& other) {
  using Unsigned = std::uint64_t __attribute__((vector_size(kLanes * sizeof(std::uint64_t))));
  return reinterpret_cast<Words>(reinterpret_cast<Unsigned>(one) + reinterpret_cast<Unsigned>(other));
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

inline ReadyRay ray_of(const Prepared& some, std::size_t lane) {
  return {{some.next[0][lane], some.next[1][lane], some.next[2][lane]},
          {some.apart[0][lane], some.apart[1][lane], some.apart[2][lane]},
          static_cast<std::uint32_t>(some.left[lane]),
          static_cast<std::uint32_t>(some.ahead[lane]),
          static_cast<std::uint64_t>(some.end[lane])};
}

inline void prepare_some(const FanLanes& fan, const double* ends_m, Prepared& out) {
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

inline void prepare(const RayFan& fan, std::span<const Eigen::Vector3d> ends_m, std::vector<ReadyRay>& ready,
                    std::vector<std::uint32_t>& others) {
  ready.resize(ends_m.size());
  std::size_t count = 0;
  const FanLanes fan_lanes(fan);
  for_each_lanes(ends_m, [&](std::size_t first, const double* some_m) {
    Prepared some;
    prepare_some(fan_lanes, some_m, some);
    for (std::size_t l = 0; l < std::min(kLanes, ends_m.size() - first); ++l) {
      if (some.is_ready[l] == 0) {
        others.push_back(static_cast<std::uint32_t>(first + l));
      } else {
        ready[count++] = ray_of(some, l);
      }
    }
  });
  ready.resize(count);
}

inline std::size_t find(const RayFan& fan, std::span<const Eigen::Vector3d> points_m, std::uint64_t* places,
                        std::vector<std::uint32_t>& outside) {
  const FanLanes fan_lanes(fan);
  CellsInARow cells(places);
  for_each_lanes(points_m, [&](std::size_t first, const double* some_m) {
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

/// axis_of_least for each lane: all bits set of the axis that is next, none of the others.
inline void choose_axes(const std::array<Words, 3>& next, std::array<Words, 3>& along) {
  const Words is_0_first = next[0] < next[1];
  along[0] = is_0_first & (next[0] < next[2]);
  along[1] = ~is_0_first & (next[1] < next[2]);
  along[2] = ~(along[0] | along[1]);
}

/// Up to kLanes rays side by side, and how many faces the shortest and the longest cross.
struct RayLanes {
  std::array<Words, 3> next{}, apart{}, step{};
  Words left{};
  std::int64_t shortest = 0, longest = 0;
};

/// @param order  rays by length, the longest first
inline void gather(std::span<const ReadyRay> rays, std::span<const std::uint32_t> order, RayLanes& to) {
  for (std::size_t l = 0; l < order.size(); ++l) {
    const ReadyRay& ray = rays[order[l]];
    for (std::size_t a = 0; a < 3; ++a) {
      to.next[a][l] = ray.next[a];
      to.apart[a][l] = ray.apart[a];
      to.step[a][l] = static_cast<std::int64_t>(step_of(a, ((ray.ahead >> a) & 1U) != 0));
    }
    to.left[l] = ray.left;
  }
  to.shortest = order.size() == kLanes ? rays[order.back()].left : 0;
  to.longest = rays[order.front()].left;
}

/// Walks rays of about the same length, face by face.
inline void mark_some(const RayLanes& rays, std::uint64_t start, ScanWindow& window, MarksToSet& to_set) {
  std::array<Words, 3> next = rays.next;
  const Words begin = Words{} + static_cast<std::int64_t>(start);
  std::array<Words, 3> bits, place;
  for (std::size_t a = 0; a < 3; ++a) {
    bits[a] = Words{} + static_cast<std::int64_t>(kAxisBits[a]);
    place[a] = begin & bits[a];
  }
  Words brick = begin >> 6, marks{};
  std::size_t count = to_set.count;
  const auto enter = [&](const Words& at) {
    const Words entered = at >> 6;
    Words cell;
    bit_of(at, cell);
    Which left;
    differ(brick, entered, left);
    store_some(left, brick, to_set.brick.data() + count);
    count += store_some(left, marks, to_set.marks.data() + count);
    keep_unless(left, marks);
    marks |= cell;
    brick = entered;
    if (count > MarksToSet::kRoom - 2 * kLanes) {
      set_marks(to_set, count, window);
      count = 0;
    }
  };
  const auto cross = [&] {
    std::array<Words, 3> along;
    choose_axes(next, along);
    for (std::size_t a = 0; a < 3; ++a) {
      const Words after = sum_of(next[a], rays.apart[a]);  // those of rays that have ended mean nothing
      next[a] = along[a] ? after : next[a];
      const Words moved = (place[a] + rays.step[a]) & bits[a];
      place[a] = along[a] ? moved : place[a];
    }
  };
  std::int64_t n = 0;
  for (; n < rays.shortest; ++n) {
    enter(place[0] | place[1] | place[2]);
    cross();
  }
  for (; n < rays.longest; ++n) {
    // A ray that has ended marks where it began once more.
    enter(rays.left > n ? place[0] | place[1] | place[2] : begin);
    cross();
  }
  Which all;
  differ(begin, begin - 1, all);
  store_some(all, brick, to_set.brick.data() + count);
  to_set.count = count + store_some(all, marks, to_set.marks.data() + count);
}

inline void mark_all(std::span<const ReadyRay> rays, std::uint64_t start, ScanWindow& window) {
  const ByLength by_length(rays);
  std::span<const std::uint32_t> order = by_length.order();
  MarksToSet to_set;
  while (!order.empty()) {
    RayLanes lanes;
    const std::size_t some = std::min(kLanes, order.size());
    gather(rays, order.first(some), lanes);
    mark_some(lanes, start, window, to_set);
    order = order.subspan(some);
  }
  set_marks(to_set, to_set.count, window);
}

#include "map/kernels/ray_keys_loops.hpp"
