#include "cloud/ray_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/internal/ray_dda.hpp"

// Highway compiles what follows up to HWY_AFTER_NAMESPACE once for each kind of machine.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cloud/ray_kernels.cpp"
#include <hwy/foreach_target.h>
// It must come after it.
#include <hwy/highway.h>

#ifndef PINGVOX_COMPRESS_TABLE
#define PINGVOX_COMPRESS_TABLE
namespace pingvox::detail {
namespace {

/// For each choice of four words, a bit each: where the halves of the chosen ones stand, one after the other.
alignas(32) [[maybe_unused]] constexpr std::array<std::array<std::uint32_t, 8>, 16> kCompressTable = [] {
  std::array<std::array<std::uint32_t, 8>, 16> all{};
  for (std::size_t some = 0; some < all.size(); ++some) {
    std::size_t count = 0;
    for (std::uint32_t half = 0; half < 8; ++half) {
      if ((some >> (half / 2) & 1) != 0) all[some][count++] = half;
    }
  }
  return all;
}();

}  // namespace
}  // namespace pingvox::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace pingvox::detail::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;
using DoubleVec = hn::Vec<D>;
using IntVec = hn::Vec<DI>;
using UintVec = hn::Vec<DU>;
using DoubleMask = hn::Mask<D>;
using IntMask = hn::Mask<DI>;

constexpr D kDoubles;
constexpr DI kInts;
constexpr DU kUints;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

std::size_t lanes() {
  return hn::Lanes(kDoubles);
}

/// Whole numbers as integers. REQUIRES numbers between -2^51 and 2^51
IntVec to_integers(DoubleVec whole) {
  constexpr double kNoFraction = 0x1.8p52;  // a number of its size has no bits for one
  return hn::BitCast(kInts, whole + hn::Set(kDoubles, kNoFraction)) -
         hn::BitCast(kInts, hn::Set(kDoubles, kNoFraction));
}

/// spread_bits (geometry/tree_order.hpp) for each lane. REQUIRES up to 11 bits
UintVec spread(UintVec words) {
  words = hn::And(hn::Or(words, hn::ShiftLeft<16>(words)), hn::Set(kUints, 0x1F0000FF0000FF));
  words = hn::And(hn::Or(words, hn::ShiftLeft<8>(words)), hn::Set(kUints, 0x100F00F00F00F00F));
  words = hn::And(hn::Or(words, hn::ShiftLeft<4>(words)), hn::Set(kUints, 0x10C30C30C30C30C3));
  return hn::And(hn::Or(words, hn::ShiftLeft<2>(words)), hn::Set(kUints, 0x1249249249249249));
}

void load(const double* points, DoubleVec& x, DoubleVec& y, DoubleVec& z) {
  hn::LoadInterleaved3(kDoubles, points, x, y, z);
}
void load(const float* points, DoubleVec& x, DoubleVec& y, DoubleVec& z) {
  const hn::Rebind<float, D> floats;
  hn::Vec<decltype(floats)> fx, fy, fz;
  hn::LoadInterleaved3(floats, points, fx, fy, fz);
  x = hn::PromoteTo(kDoubles, fx);
  y = hn::PromoteTo(kDoubles, fy);
  z = hn::PromoteTo(kDoubles, fz);
}

/// Stores those lanes that a mask has, one after the other, where there is room for all.
void compress_store(UintVec words, hn::Mask<DU> mask, std::uint64_t* to) {
  // Compiled by g++, Compress of Highway 1.0.3 copies its tables to the stack each time; CompressStore is slow on
  // Zen 4.
#if HWY_TARGET == HWY_AVX3
  _mm512_storeu_si512(to, _mm512_maskz_compress_epi64(mask.raw, words.raw));
#elif HWY_TARGET == HWY_AVX2
  const auto some = static_cast<std::size_t>(_mm256_movemask_pd(_mm256_castsi256_pd(mask.raw)));
  const __m256i halves = _mm256_load_si256(reinterpret_cast<const __m256i*>(kCompressTable[some].data()));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_permutevar8x32_epi32(words.raw, halves));
#else
  hn::CompressStore(words, mask, kUints, to);
#endif
}

/// Points in cells; those outside of the window are moved to its lowest corner.
struct Points {
  DoubleVec x, y, z;
  DoubleMask is_inside;
};

template <class Real>
Points load_points(const RayGrid& grid, const Real* points_m) {
  DoubleVec x, y, z;
  load(points_m, x, y, z);
  const DoubleVec cells_per_m = hn::Set(kDoubles, grid.cells_per_m);
  const auto is_inside_along = [&](DoubleVec at, std::size_t a) HWY_ATTR {
    return hn::And(hn::Ge(at, hn::Set(kDoubles, grid.inside_from[a])),
                   hn::Lt(at, hn::Set(kDoubles, grid.inside_to[a])));
  };
  x = x * cells_per_m;
  y = y * cells_per_m;
  z = z * cells_per_m;
  const DoubleMask is_inside = hn::And(is_inside_along(x, 0), hn::And(is_inside_along(y, 1), is_inside_along(z, 2)));
  const auto moved_along = [&](DoubleVec at, std::size_t a) HWY_ATTR {
    return hn::IfThenElse(is_inside, at, hn::Set(kDoubles, static_cast<double>(grid.lowest[a])));
  };
  // As one list: for ARM64, g++ 12 cannot compile Points' default constructor, which no target attribute reaches.
  return {moved_along(x, 0), moved_along(y, 1), moved_along(z, 2), is_inside};
}

/// The bits of one axis of the places of cells.
UintVec axis_of_place(const RayGrid& grid, DoubleVec cell, std::size_t a) {
  const DoubleVec in_window = cell - hn::Set(kDoubles, static_cast<double>(grid.lowest[a]));
  return spread(hn::BitCast(kUints, to_integers(in_window)));
}

/// As many points as there are lanes, from the one with the number `first` on; those behind the last one are no
/// numbers.
/// @param room  where they stand if they are fewer
template <class Point>
const typename Point::Scalar* points_from(std::span<const Point> points_m, std::size_t first,
                                          std::span<typename Point::Scalar> room) {
  if (first + lanes() <= points_m.size()) return points_m[first].data();
  std::fill(room.begin(), room.end(), std::numeric_limits<typename Point::Scalar>::quiet_NaN());
  for (std::size_t i = first; i < points_m.size(); ++i) {
    std::copy_n(points_m[i].data(), 3, room.data() + 3 * (i - first));
  }
  return room.data();
}
constexpr std::size_t kPointRoom = 3 * HWY_MAX_BYTES / sizeof(double);

/// State that the axes of rays share.
struct Preparing {
  IntVec left, ahead;
  // The last face that is crossed, and the first one beyond an end, along the axes so far.
  IntVec last_crossing, beyond_end;
  UintVec start, end;
};

/// What FaceCrossings counts along one axis, for rays between these coordinates [cells].
void prepare_axis(const RayGrid& grid, std::size_t a, DoubleVec from, DoubleVec to, std::size_t first, Preparing& all,
                  PreparedRays& rays) {
  const DoubleVec kOne = hn::Set(kDoubles, 1.0), kUnits = hn::Set(kDoubles, 0x1p62);
  const DoubleVec first_cell = hn::Floor(from), last_cell = hn::Floor(to);
  const DoubleMask is_ahead = hn::Ge(last_cell, first_cell);
  const DoubleVec faces = hn::Abs(last_cell - first_cell);
  const DoubleMask some = hn::Gt(faces, hn::Zero(kDoubles)), several = hn::Gt(faces, kOne);
  const DoubleVec length = hn::IfThenElse(some, hn::Abs(to - from), kOne);
  const DoubleVec to_first = hn::IfThenElse(is_ahead, first_cell + kOne - from, from - first_cell) / length * kUnits;
  const DoubleVec between = kOne / length * kUnits;

  const IntMask some_ints = hn::RebindMask(kInts, some), several_ints = hn::RebindMask(kInts, several);
  const IntVec next = hn::ConvertTo(kInts, hn::IfThenElseZero(some, to_first));
  const IntVec apart = hn::ConvertTo(kInts, hn::IfThenElseZero(several, between));
  const IntVec never = hn::Set(kInts, kNever), face_count = to_integers(faces);
  hn::StoreU(hn::IfThenElse(some_ints, next, never), kInts, rays.next[a].data() + first);
  // Behind its only face nothing is left.
  hn::StoreU(hn::IfThenElse(several_ints, apart, hn::IfThenElseZero(some_ints, never - next)), kInts,
             rays.apart[a].data() + first);
  // What does not fit becomes negative, and the ray is not taken.
  const IntVec last_crossing = next + (face_count - hn::Set(kInts, 1)) * apart;
  const IntVec beyond = last_crossing + apart;
  all.last_crossing =
      hn::IfThenElse(hn::And(some_ints, last_crossing > all.last_crossing), last_crossing, all.last_crossing);
  all.beyond_end = hn::IfThenElse(hn::And(several_ints, beyond < all.beyond_end), beyond, all.beyond_end);
  all.left = all.left + face_count;
  all.ahead =
      hn::Or(all.ahead, hn::IfThenElseZero(hn::RebindMask(kInts, is_ahead), hn::Set(kInts, std::int64_t{1} << a)));
  const auto shift = static_cast<int>(a);
  all.start = hn::Or(all.start, hn::ShiftLeftSame(axis_of_place(grid, first_cell, a), shift));
  all.end = hn::Or(all.end, hn::ShiftLeftSame(axis_of_place(grid, last_cell, a), shift));
}

template <class Point>
void prepare(const RayGrid& grid, std::span<const Eigen::Vector3d> from_m, std::span<const Point> to_m,
             PreparedRays& rays) {
  const std::size_t room = (to_m.size() + lanes() - 1) / lanes() * lanes();
  for (auto* all : {&rays.next[0], &rays.next[1], &rays.next[2], &rays.apart[0], &rays.apart[1], &rays.apart[2],
                    &rays.left, &rays.ahead}) {
    all->resize(room);
  }
  rays.start.resize(room);
  rays.end.resize(room);
  rays.count = to_m.size();
  std::array<double, kPointRoom> from_room{};
  std::array<typename Point::Scalar, kPointRoom> to_room{};
  for (std::size_t first = 0; first < to_m.size(); first += lanes()) {
    const Points from = load_points(grid, points_from(from_m, first, std::span(from_room)));
    const Points to = load_points(grid, points_from(to_m, first, std::span(to_room)));
    Preparing all{hn::Zero(kInts),        hn::Zero(kInts),  hn::Set(kInts, std::numeric_limits<std::int64_t>::min()),
                  hn::Set(kInts, kNever), hn::Zero(kUints), hn::Zero(kUints)};
    prepare_axis(grid, 0, from.x, to.x, first, all, rays);
    prepare_axis(grid, 1, from.y, to.y, first, all, rays);
    prepare_axis(grid, 2, from.z, to.z, first, all, rays);
    // Whether sums of these units give the order of faces that FaceCrossings gives.
    const auto kMaxFaces = static_cast<std::int64_t>(FaceCrossings::kMaxFacesIn64Bits);
    const IntMask is_inside = hn::RebindMask(kInts, hn::And(from.is_inside, to.is_inside));
    const IntMask is_ready =
        hn::And(hn::And(is_inside, all.beyond_end > all.last_crossing), all.left < hn::Set(kInts, kMaxFaces + 1));
    hn::StoreU(hn::IfThenElseZero(is_ready, all.left), kInts, rays.left.data() + first);
    hn::StoreU(all.ahead, kInts, rays.ahead.data() + first);
    hn::StoreU(all.start, kUints, rays.start.data() + first);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(kUints, is_ready), all.end, hn::Set(kUints, kNoPlace)), kUints,
               rays.end.data() + first);
  }
}

template <class Point>
void find_each_place(const RayGrid& grid, std::span<const Point> points_m, std::vector<std::uint64_t>& places) {
  places.resize((points_m.size() + lanes() - 1) / lanes() * lanes());
  std::array<typename Point::Scalar, kPointRoom> room{};
  for (std::size_t first = 0; first < points_m.size(); first += lanes()) {
    const Points points = load_points(grid, points_from(points_m, first, std::span(room)));
    const UintVec x = axis_of_place(grid, hn::Floor(points.x), 0), y = axis_of_place(grid, hn::Floor(points.y), 1),
                  z = axis_of_place(grid, hn::Floor(points.z), 2);
    const UintVec place = hn::Or(x, hn::Or(hn::ShiftLeft<1>(y), hn::ShiftLeft<2>(z)));
    const auto is_inside = hn::RebindMask(kUints, points.is_inside);
    hn::StoreU(hn::IfThenElse(is_inside, place, hn::Set(kUints, kNoPlace)), kUints, places.data() + first);
  }
  places.resize(points_m.size());
}

/// Words of marks that are to be set: a ray's marks in a brick are one word.
struct MarksToSet {
  static constexpr std::size_t kRoom = 1024;
  std::array<std::uint64_t, kRoom> word, marks;
  std::size_t count = 0;

  void set(ScanWindow& window) {
    std::uint64_t* const missed = window.missed();
    std::uint8_t* const touched = window.touched();
    for (std::size_t i = 0; i < count; ++i) {
      missed[word[i]] |= marks[i];
      touched[word[i] / 64] = 1;
    }
    count = 0;
  }
};

/// Positions of rays along one axis.
struct Axis {
  /// @param rays   which ones, as many as there are lanes
  /// @param start  places where they begin
  Axis(const PreparedRays& all, IntVec rays, IntVec ahead, std::size_t a, UintVec start)
      : next(hn::GatherIndex(kInts, all.next[a].data(), rays)),
        apart(hn::GatherIndex(kInts, all.apart[a].data(), rays)),
        bits(hn::Set(kUints, kPlaceBits[a])),
        place(hn::And(start, hn::Set(kUints, kPlaceBits[a]))) {
    // Added before the bits are masked: a carry must run through the bits of the other axes.
    const std::uint64_t axis_bits = kPlaceBits[a], lowest = axis_bits & (~axis_bits + 1);
    const IntVec flag = hn::Set(kInts, std::int64_t{1} << a);
    step = hn::IfThenElse(hn::RebindMask(kUints, hn::Eq(hn::And(ahead, flag), flag)), hn::Set(kUints, ~axis_bits + 1),
                          hn::Set(kUints, ~lowest + 1));
  }
  /// Crosses a face where `is` is set.
  void cross(IntMask is) {
    // For a ray that has ended the next face is meaningless.
    const auto is_word = hn::RebindMask(kUints, is);
#if HWY_TARGET == HWY_AVX3
    next = hn::IfThenElse(is, next + apart, next);
    place = hn::IfThenElse(is_word, hn::And(place + step, bits), place);
#else
    // Selecting between two values is slower than masking one.
    next = next + hn::IfThenElseZero(is, apart);
    place = hn::And(place + hn::IfThenElseZero(is_word, step), bits);
#endif
  }
  IntVec next, apart;
  UintVec bits, place, step;
};

/// Walks rays of about the same length, face by face.
/// @param numbers  of as many as there are lanes, the one with most faces first
void mark_vector(const PreparedRays& all, const std::int64_t* numbers, MarksToSet& to_set, ScanWindow& window) {
  const IntVec rays = hn::LoadU(kInts, numbers);
  const IntVec left = hn::GatherIndex(kInts, all.left.data(), rays);
  const IntVec ahead = hn::GatherIndex(kInts, all.ahead.data(), rays);
  const std::int64_t longest = all.left[static_cast<std::size_t>(numbers[0])];
  const std::int64_t shortest = all.left[static_cast<std::size_t>(numbers[lanes() - 1])];
  const UintVec begin = hn::GatherIndex(kUints, all.start.data(), rays);
  Axis x(all, rays, ahead, 0, begin), y(all, rays, ahead, 1, begin), z(all, rays, ahead, 2, begin);
  const UintVec one = hn::Set(kUints, 1), cell_bits = hn::Set(kUints, 63);
  UintVec word = hn::ShiftRight<6>(begin), marks = hn::Zero(kUints);
  std::size_t count = to_set.count;
  for (std::int64_t n = 0; n < longest; ++n) {
    UintVec at = hn::Or(x.place, hn::Or(y.place, z.place));
    if (n >= shortest) {
      // A ray that has ended marks where it began once more.
      at = hn::IfThenElse(hn::RebindMask(kUints, left > hn::Set(kInts, n)), at, begin);
    }
    const UintVec entered = hn::ShiftRight<6>(at), cell = one << hn::And(at, cell_bits);
    const auto moved_on = hn::Ne(entered, word);
    compress_store(word, moved_on, to_set.word.data() + count);
    compress_store(marks, moved_on, to_set.marks.data() + count);
    count += hn::CountTrue(kUints, moved_on);
    marks = hn::Or(hn::IfThenZeroElse(moved_on, marks), cell);
    word = entered;
    if (count > MarksToSet::kRoom - 2 * lanes()) {
      to_set.count = count;
      to_set.set(window);
      count = 0;
    }
    // axis_of_min for each lane.
    const IntMask x_before_y = x.next < y.next, x_before_z = x.next < z.next, y_before_z = y.next < z.next;
    const IntMask is_x = hn::And(x_before_y, x_before_z), is_y = hn::AndNot(x_before_y, y_before_z);
    x.cross(is_x);
    y.cross(is_y);
    z.cross(hn::Not(hn::Or(is_x, is_y)));
  }
  hn::StoreU(word, kUints, to_set.word.data() + count);
  hn::StoreU(marks, kUints, to_set.marks.data() + count);
  to_set.count = count + lanes();
}

/// Numbers of the rays that are ready, those that cross most faces first, so that neighbours end nearly together; then
/// the last of them again, up to whole vectors.
std::vector<std::int64_t> order_by_length(const PreparedRays& rays) {
  const auto first = rays.left.begin(), last = first + static_cast<std::ptrdiff_t>(rays.count);
  const std::int64_t most = rays.count == 0 ? 0 : *std::max_element(first, last);
  std::vector<std::uint32_t> place(static_cast<std::size_t>(most) + 2);
  const auto slot = [&](std::size_t i) { return static_cast<std::size_t>(most - rays.left[i]); };
  for (std::size_t i = 0; i < rays.count; ++i) ++place[slot(i) + 1];
  for (std::size_t i = 1; i < place.size(); ++i) place[i] += place[i - 1];
  std::vector<std::int64_t> order(place[static_cast<std::size_t>(most)]);
  for (std::size_t i = 0; i < rays.count; ++i) {
    if (rays.left[i] > 0) order[place[slot(i)]++] = static_cast<std::int64_t>(i);
  }
  if (!order.empty()) order.resize((order.size() + lanes() - 1) / lanes() * lanes(), order.back());
  return order;
}

void mark(const PreparedRays& rays, ScanWindow& window) {
  const std::vector<std::int64_t> order = order_by_length(rays);
  MarksToSet to_set;
  for (std::size_t i = 0; i < order.size(); i += lanes()) mark_vector(rays, order.data() + i, to_set, window);
  to_set.set(window);
}

}  // namespace

void prepare_doubles_here(const RayGrid& grid, std::span<const Eigen::Vector3d> from_m,
                          std::span<const Eigen::Vector3d> to_m, PreparedRays& rays) {
  prepare(grid, from_m, to_m, rays);
}
void prepare_floats_here(const RayGrid& grid, std::span<const Eigen::Vector3d> from_m,
                         std::span<const Eigen::Vector3f> to_m, PreparedRays& rays) {
  prepare(grid, from_m, to_m, rays);
}
void find_places_of_doubles(const RayGrid& grid, std::span<const Eigen::Vector3d> points_m,
                            std::vector<std::uint64_t>& places) {
  find_each_place(grid, points_m, places);
}
void find_places_of_floats(const RayGrid& grid, std::span<const Eigen::Vector3f> points_m,
                           std::vector<std::uint64_t>& places) {
  find_each_place(grid, points_m, places);
}
void mark_rays_here(const PreparedRays& rays, ScanWindow& window) {
  mark(rays, window);
}

}  // namespace pingvox::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pingvox::detail {
namespace {
HWY_EXPORT(prepare_doubles_here);
HWY_EXPORT(prepare_floats_here);
HWY_EXPORT(find_places_of_doubles);
HWY_EXPORT(find_places_of_floats);
HWY_EXPORT(mark_rays_here);
}  // namespace

void prepare_rays(const RayGrid& grid, std::span<const Eigen::Vector3d> from_m, std::span<const Eigen::Vector3d> to_m,
                  PreparedRays& rays) {
  HWY_DYNAMIC_DISPATCH(prepare_doubles_here)(grid, from_m, to_m, rays);
}
void prepare_rays(const RayGrid& grid, std::span<const Eigen::Vector3d> from_m, std::span<const Eigen::Vector3f> to_m,
                  PreparedRays& rays) {
  HWY_DYNAMIC_DISPATCH(prepare_floats_here)(grid, from_m, to_m, rays);
}
void find_places(const RayGrid& grid, std::span<const Eigen::Vector3d> points_m, std::vector<std::uint64_t>& places) {
  HWY_DYNAMIC_DISPATCH(find_places_of_doubles)(grid, points_m, places);
}
void find_places(const RayGrid& grid, std::span<const Eigen::Vector3f> points_m, std::vector<std::uint64_t>& places) {
  HWY_DYNAMIC_DISPATCH(find_places_of_floats)(grid, points_m, places);
}
void mark_rays(const PreparedRays& rays, ScanWindow& window) {
  HWY_DYNAMIC_DISPATCH(mark_rays_here)(rays, window);
}

}  // namespace pingvox::detail
#endif
