// Loops over lanes that write the keys of rays, included by ray_lanes.cpp behind ray_lanes_loops.hpp.

inline void prepare_some(const KeyGrid& grid, const Segment* segments, Prepared& out) {
  std::array<Eigen::Vector3d, kLanes> begins_m, ends_m;
  for (std::size_t l = 0; l < kLanes; ++l) {
    begins_m[l] = segments[l].from_m;
    ends_m[l] = segments[l].to_m;
  }
  std::array<Doubles, 3> from, to;
  load(begins_m[0].data(), from);
  load(ends_m[0].data(), to);
  Words inside = Words{} - 1;
  for (std::size_t a = 0; a < 3; ++a) {
    from[a] *= grid.cells_per_m;
    to[a] *= grid.cells_per_m;
    inside &= (from[a] >= -grid.half) & (from[a] < grid.half) & (to[a] >= -grid.half) & (to[a] < grid.half);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    Words first, last;
    prepare_axis(inside ? from[a] : Doubles{}, inside ? to[a] : Doubles{}, a, out, first, last);
    out.end |= (first + static_cast<std::int64_t>(grid.half)) << (16 * a);
  }
  decide(inside, out);
}

inline void prepare(const KeyGrid& grid, std::span<const Segment> segments, std::span<ReadyRay> ready,
                    std::vector<std::uint32_t>& others) {
  for (std::size_t first = 0; first < segments.size(); first += kLanes) {
    const std::size_t lanes = std::min(kLanes, segments.size() - first);
    std::array<Segment, kLanes> padded;
    Prepared some;
    prepare_some(grid, some_from(segments, first, padded), some);
    std::array<ReadyRay, kLanes> rays;
    rays_of(some, rays);
    for (std::size_t l = 0; l < lanes; ++l) {
      ready[first + l] = rays[l];
      if (some.is_ready[l] != 0) continue;
      ready[first + l].left = 0;
      others.push_back(static_cast<std::uint32_t>(first + l));
    }
  }
}

using PerLane = std::array<std::int64_t, kLanes>;

inline void load(const PerLane& words, Words& into) {
  static_assert(sizeof words == sizeof into);
  std::memcpy(&into, words.data(), sizeof into);
}

/// Writes the keys of kLanes rays of about the same length, the longest first.
/// @param spill  where the keys go of rays that have ended, room for as many as the longest has and one more
inline void write_some(std::span<const ReadyRay> rays, std::span<const std::uint32_t> order, std::span<Key* const> keys,
                       Key* spill) {
  // Vectors that are written lane by lane stay in memory, and to read a part of one that was just stored takes long:
  // so by way of arrays into vectors, and each lane's key straight out of its vector.
  std::array<PerLane, 3> nexts, aparts, steps;
  PerLane begins;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const ReadyRay& ray = rays[order[l]];
    for (std::size_t a = 0; a < 3; ++a) {
      nexts[a][l] = ray.next[a];
      aparts[a][l] = ray.apart[a];
      steps[a][l] = key_step(a, ray);
    }
    begins[l] = static_cast<std::int64_t>(ray.end);
  }
  std::array<Words, 3> next, apart, step, along;
  for (std::size_t a = 0; a < 3; ++a) {
    load(nexts[a], next[a]);
    load(aparts[a], apart[a]);
    load(steps[a], step[a]);
  }
  Words at;
  load(begins, at);
  std::array<Key*, kLanes> to;
  for (std::size_t l = 0; l < kLanes; ++l) to[l] = keys[order[l]];
  std::uint32_t n = 0;
  for (std::size_t shortest = kLanes; shortest-- > 0;) {
    for (const std::uint32_t end = rays[order[shortest]].left; n < end; ++n) {
      for (std::size_t l = 0; l < kLanes; ++l) put(static_cast<std::uint64_t>(at[l]), to[l] + n);
      choose_axes(next, along);
      for (std::size_t a = 0; a < 3; ++a) {
        next[a] = sum_of(next[a], along[a] & apart[a]);
        at = sum_of(at, along[a] & step[a]);
      }
    }
    to[shortest] = spill;
  }
}

inline void write_all(std::span<const ReadyRay> rays, std::span<Key* const> keys) {
  const ByLength by_length(rays);
  std::span<const std::uint32_t> order = by_length.order();
  std::vector<Key> spill(order.empty() ? 0 : rays[order.front()].left + 1);
  for (; order.size() >= kLanes; order = order.subspan(kLanes)) {
    write_some(rays, order.first(kLanes), keys, spill.data());
  }
  for (const std::uint32_t i : order) write_one(rays[i], keys[i]);
}
