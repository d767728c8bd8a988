#include "map/kernels/ray_lanes.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "map/tree_order.hpp"
#include "pingvox/map/ray_dda.hpp"

namespace pingvox::detail {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
constexpr double kUnits = 0x1p62;  // of a ray's length

/// What to add to an axis' bits, before they are masked, for one cell ahead or back: a carry must run through the bits
/// of the other axes.
constexpr std::uint64_t step_of(std::uint64_t axis_bits, bool is_ahead) {
  const std::uint64_t lowest = axis_bits & (~axis_bits + 1);
  return is_ahead ? ~axis_bits + 1 : ~lowest + 1;
}

/// All bits set of the axis that axis_of_least gives, none of the others. There are no branches and no numbers picked
/// by their place: which axis is next is as good as random, and picking waits for what was just written.
std::array<std::uint64_t, 3> along_least(const std::array<std::int64_t, 3>& next) {
  const auto is_0_first = static_cast<std::uint64_t>(next[0] < next[1]);
  const auto is_0 = is_0_first & static_cast<std::uint64_t>(next[0] < next[2]);
  const auto is_1 = ~is_0_first & static_cast<std::uint64_t>(next[1] < next[2]);
  return {0 - is_0, 0 - is_1, (is_0 | is_1) - 1};
}

/// Those of the axes that along_least gives.
std::int64_t some_of(std::int64_t number, std::uint64_t along) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(number) & along);
}

void mark_one_by_one(std::span<const ReadyRay> rays, std::uint64_t start, ScanWindow& window) {
  std::uint64_t* const missed = window.missed();
  std::uint8_t* const touched = window.touched();
  for (const ReadyRay& ray : rays) {
    std::array<std::int64_t, 3> next = ray.next;
    std::array<std::uint64_t, 3> step{}, place{};
    for (std::size_t a = 0; a < 3; ++a) {
      step[a] = step_of(kAxisBits[a], ((ray.ahead >> a) & 1U) != 0);
      place[a] = start & kAxisBits[a];
    }
    for (std::uint32_t left = ray.left; left > 0; --left) {
      mark_place(place[0] | place[1] | place[2], missed, touched);
      const std::array<std::uint64_t, 3> along = along_least(next);
      for (std::size_t a = 0; a < 3; ++a) {
        next[a] += some_of(ray.apart[a], along[a]);
        place[a] = (place[a] + (step[a] & along[a])) & kAxisBits[a];
      }
    }
  }
}

/// Rays by the number of faces that they cross, most first, so that eight neighbours end nearly together.
class ByLength {
 public:
  explicit ByLength(std::span<const ReadyRay> rays) : order_(rays.size()) {
    std::uint32_t most = 0;
    for (const ReadyRay& ray : rays) most = std::max(most, ray.left);
    std::vector<std::uint32_t> place(most + 2);
    for (const ReadyRay& ray : rays) ++place[most - ray.left + 1];
    for (std::size_t i = 1; i < place.size(); ++i) place[i] += place[i - 1];
    for (std::size_t i = 0; i < rays.size(); ++i) order_[place[most - rays[i].left]++] = static_cast<std::uint32_t>(i);
    while (!order_.empty() && rays[order_.back()].left == 0) order_.pop_back();
  }
  std::span<const std::uint32_t> order() const { return order_; }

 private:
  std::vector<std::uint32_t> order_;
};

/// Words of marks that are to be set: walked together, a ray's marks in a brick are one word.
struct MarksToSet {
  static constexpr std::size_t kRoom = 1024;
  std::array<std::uint64_t, kRoom> word, marks;
  std::size_t count = 0;
};

void set_marks(const MarksToSet& to_set, std::size_t count, ScanWindow& window) {
  std::uint64_t* const missed = window.missed();
  std::uint8_t* const touched = window.touched();
  for (std::size_t i = 0; i < count; ++i) {
    missed[to_set.word[i]] |= to_set.marks[i];
    touched[to_set.word[i] / 64] = 1;
  }
}

/// The words of a window's layer.
struct Layer {
  std::uint64_t* words;
};
/// Bits of x and y in a place in a layer.
constexpr std::array<std::uint64_t, 2> kLayerBits{0x5555555555555555U, 0xAAAAAAAAAAAAAAAAU};

void set_marks(const MarksToSet& to_set, std::size_t count, const Layer& layer) {
  for (std::size_t i = 0; i < count; ++i) layer.words[to_set.word[i]] |= to_set.marks[i];
}

/// Whether rays stay in the layer of cells where they begin, and cross so many that it pays to look for its pages.
bool are_flat(std::span<const ReadyRay> rays, const ScanWindow& window) {
  constexpr std::size_t kFacesPerPage = 8;
  std::size_t faces = 0;
  for (const ReadyRay& ray : rays) {
    if (ray.next[2] != kNever) return false;
    faces += ray.left;
  }
  return faces > kFacesPerPage * window.layer_pages();
}

/// What one face along an axis adds to a packed key.
std::int64_t key_step(std::size_t axis, const ReadyRay& ray) {
  const std::int64_t one = std::int64_t{1} << (16 * axis);
  return ((ray.ahead >> axis) & 1U) != 0 ? one : -one;
}

/// Writes a packed key, and two bytes behind it that the next one overwrites.
inline void put(std::uint64_t key, Key* to) {
  static_assert(sizeof(Key) == 6);
  std::memcpy(static_cast<void*>(to), &key, sizeof key);
}

void write_one(const ReadyRay& ray, Key* keys) {
  std::array<std::int64_t, 3> next = ray.next;
  const std::array<std::int64_t, 3> step{key_step(0, ray), key_step(1, ray), key_step(2, ray)};
  auto at = static_cast<std::int64_t>(ray.end);
  for (std::uint32_t n = 0; n < ray.left; ++n) {
    put(static_cast<std::uint64_t>(at), keys + n);
    const std::array<std::uint64_t, 3> along = along_least(next);
    for (std::size_t a = 0; a < 3; ++a) {
      next[a] += some_of(ray.apart[a], along[a]);
      at += some_of(step[a], along[a]);
    }
  }
}

void write_one_by_one(std::span<const ReadyRay> rays, std::span<Key* const> keys) {
  for (std::size_t i = 0; i < rays.size(); ++i) write_one(rays[i], keys[i]);
}

// The same loops for each kind of machine.
#define PINGVOX_LOOPS "map/kernels/ray_lanes_loops.hpp"
#include "map/kernels/each_machine.hpp"

}  // namespace

template <class Point>
void prepare_rays(Lanes lanes, const RayFan& fan, std::span<const Point> ends_m, std::vector<ReadyRay>& ready,
                  std::vector<std::uint32_t>& others) {
  PINGVOX_BY_LANES(lanes, prepare(fan, ends_m, ready, others), plain::prepare(fan, ends_m, ready, others));
}
template void prepare_rays(Lanes, const RayFan&, std::span<const Eigen::Vector3d>, std::vector<ReadyRay>&,
                           std::vector<std::uint32_t>&);
template void prepare_rays(Lanes, const RayFan&, std::span<const Eigen::Vector3f>, std::vector<ReadyRay>&,
                           std::vector<std::uint32_t>&);

template <class Point>
std::size_t find_cells(Lanes lanes, const RayFan& fan, std::span<const Point> points_m, std::span<std::uint64_t> places,
                       std::vector<std::uint32_t>& outside) {
  assert(places.size() >= points_m.size() + kWrittenBeyond);
  PINGVOX_BY_LANES(lanes, find(fan, points_m, places.data(), outside),
                   plain::find(fan, points_m, places.data(), outside));
}
template std::size_t find_cells(Lanes, const RayFan&, std::span<const Eigen::Vector3d>, std::span<std::uint64_t>,
                                std::vector<std::uint32_t>&);
template std::size_t find_cells(Lanes, const RayFan&, std::span<const Eigen::Vector3f>, std::span<std::uint64_t>,
                                std::vector<std::uint32_t>&);

void find_middles(Lanes lanes, const RayFan& fan, double resolution_m, std::span<const std::uint64_t> places,
                  std::span<Eigen::Vector3d> middles_m) {
  assert(places.size() == middles_m.size());
  PINGVOX_BY_LANES(lanes, find_middles(fan, resolution_m, places, middles_m),
                   plain::find_middles(fan, resolution_m, places, middles_m));
}

void mark_rays(Lanes lanes, std::span<const ReadyRay> rays, std::uint64_t start, [[maybe_unused]] MissesIn where,
               ScanWindow& window) {
  PINGVOX_BY_LANES(lanes, mark_all(rays, start, where, window), mark_one_by_one(rays, start, window));
}

void prepare_rays(Lanes lanes, const KeyGrid& grid, std::span<const Segment> segments, std::span<ReadyRay> ready,
                  std::vector<std::uint32_t>& others) {
  assert(ready.size() == segments.size());
  PINGVOX_BY_LANES(lanes, prepare(grid, segments, ready, others), plain::prepare(grid, segments, ready, others));
}

void write_keys(Lanes lanes, std::span<const ReadyRay> rays, std::span<Key* const> keys) {
  assert(rays.size() == keys.size());
  PINGVOX_BY_LANES(lanes, write_all(rays, keys), write_one_by_one(rays, keys));
}

}  // namespace pingvox::detail
