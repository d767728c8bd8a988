#include "map/dense_fan.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "map/tree_order.hpp"

namespace pingvox::detail {
namespace {

/// Rays that are walked or aimed together.
constexpr std::size_t kBlock = 1024;
/// Below, to look where rays go costs more than to walk each.
constexpr std::size_t kManyRays = 8192;
/// So many rays must make a run, and go through a square, or walking each of them is quicker.
constexpr std::size_t kInOrder = 2, kDense = 8;
/// So many squares to a ray at most, with and without rays: what is kept must not grow with the range alone.
constexpr std::size_t kMostSquares = 4;
/// So many to each square at the fan's border: the cells there are asked in vain.
constexpr std::size_t kPerBorder = 64;

/// Cells of a brick next to those of a mask, along one axis; bits are in the tree's order.
class BrickNeighbours {
 public:
  constexpr explicit BrickNeighbours(unsigned axis)
      : one_(1U << axis), two_(8U << axis), even_(kEven[axis]), low_(kLow[axis]) {}
  constexpr std::uint64_t ahead(std::uint64_t cells) const {
    return (cells & even_) << one_ | (cells & ~even_ & low_) << (two_ - one_);
  }
  constexpr std::uint64_t behind(std::uint64_t cells) const {
    return (cells & ~even_) >> one_ | (cells & even_ & ~low_) >> (two_ - one_);
  }
  /// Cells that border on those of the next brick, and of the one before.
  constexpr std::uint64_t before_next(std::uint64_t next) const { return (next & even_ & low_) << (one_ + two_); }
  constexpr std::uint64_t after_last(std::uint64_t last) const { return (last & ~even_ & ~low_) >> (one_ + two_); }

 private:
  /// Cells with an even coordinate, and with one below 2.
  static constexpr std::array<std::uint64_t, 3> kEven{0x5555555555555555U, 0x3333333333333333U, 0x0F0F0F0F0F0F0F0FU};
  static constexpr std::array<std::uint64_t, 3> kLow{0x00FF00FF00FF00FFU, 0x0000FFFF0000FFFFU, 0x00000000FFFFFFFFU};
  unsigned one_, two_;
  std::uint64_t even_, low_;
};
constexpr std::array<BrickNeighbours, 3> kAlong{BrickNeighbours(0), BrickNeighbours(1), BrickNeighbours(2)};

/// The number one further along an axis, in the tree's order. What leaves `all` (the highest number) wraps around.
constexpr std::uint64_t next_number(std::uint64_t number, unsigned axis, std::uint64_t all) {
  const std::uint64_t bits = kAxisBits[axis];
  return (((number | ~bits) + 1) & bits & all) | (number & ~bits);
}
constexpr std::uint64_t number_before(std::uint64_t number, unsigned axis, std::uint64_t all) {
  const std::uint64_t bits = kAxisBits[axis];
  return (((number & bits) - 1) & bits & all) | (number & ~bits);
}

}  // namespace

template <class Point>
std::size_t DenseFan<Point>::mark(std::span<const Point> ends_m, RayEnds ends, std::vector<std::uint32_t>& others) {
  ends_m_ = ends_m;
  others_ = &others;
  walked_ = 0;
  // The cells where rays end without a hit would ask for all of them.
  if (ends == RayEnds::kNothing || !mark_dense()) walk_all(ends);
  return walked_;
}

template <class Point>
bool DenseFan<Point>::mark_dense() {
  if (ends_m_.size() < kManyRays || std::size_t{6} * squares_ * squares_ > kMostSquares * ends_m_.size()) return false;
  RayRuns& rays = room_.rays;
  rays.begin(lanes_, fan_, squares_);
  std::array<std::uint64_t, kBlock + kWrittenBeyond> places;
  std::array<std::uint32_t, kBlock + kWrittenBeyond> square;
  std::array<Aim, kBlock + kWrittenBeyond> aim;
  for (std::size_t first = 0; first < ends_m_.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, ends_m_.size() - first);
    const AimedRays aimed{places, square, aim};
    const std::size_t cells = aim_rays(lanes_, fan_, squares_, ends_m_.subspan(first, count), aimed);
    mark_hits(std::span(places).first(cells), window_, places.data());
    rays.add(aimed, count);
    if (rays.rays() < kInOrder * rays.runs() || rays.rays() < kDense * rays.squares()) return false;
  }
  if (rays.rays() < kPerBorder * rays.border()) return false;
  rays.sort();
  rays.take_one_of_each_square(room_.found);
  walk(room_.found);
  walk_the_rest();
  others_->insert(others_->end(), rays.outside().begin(), rays.outside().end());
  return true;
}

template <class Point>
void DenseFan<Point>::walk_all(RayEnds ends) {
  for (std::size_t first = 0; first < ends_m_.size(); first += kBlock) {
    walk_some(ends_m_.subspan(first, std::min(kBlock, ends_m_.size() - first)), ends, MissesIn::kMaskOrLayer,
              [first](std::uint32_t i) { return static_cast<std::uint32_t>(first) + i; });
  }
}

template <class Point>
void DenseFan<Point>::walk(std::span<const std::uint32_t> rays) {
  for (std::size_t first = 0; first < rays.size(); first += kBlock) {
    const std::span<const std::uint32_t> some = rays.subspan(first, std::min(kBlock, rays.size() - first));
    room_.walked_ends_m.clear();
    for (const std::uint32_t ray : some) room_.walked_ends_m.push_back(ends_m_[ray].template cast<double>());
    walk_some(std::span<const Eigen::Vector3d>(room_.walked_ends_m), RayEnds::kMarked, MissesIn::kMask,
              [some](std::uint32_t i) { return some[i]; });
  }
}

template <class Point>
template <class End, class NumberOf>
void DenseFan<Point>::walk_some(std::span<const End> ends_m, RayEnds ends, MissesIn where, NumberOf&& number_of) {
  walked_ += ends_m.size();
  room_.not_ready.clear();
  prepare_rays(lanes_, fan_, ends_m, room_.ready, room_.not_ready);
  if (ends == RayEnds::kHit) {
    for (const ReadyRay& ray : room_.ready) mark_hit(ray.end, window_);
  }
  mark_rays(lanes_, room_.ready, start_, where, window_);
  for (const std::uint32_t i : room_.not_ready) others_->push_back(number_of(i));
}

template <class Point>
void DenseFan<Point>::walk_the_rest() {
  const std::uint64_t last_page = window_.pages() - 1;
  std::vector<std::uint8_t>& touched = room_.is_touched;
  std::vector<std::uint64_t>& to_ask = room_.to_ask;
  touched.assign(window_.pages(), 0);
  room_.all_asked.clear();
  do {
    to_ask.clear();
    room_.is_to_ask.assign(window_.pages(), 0);
    const auto ask = [&](std::uint64_t page) {
      if (std::exchange(room_.is_to_ask[page], std::uint8_t{1}) == 0) to_ask.push_back(page);
    };
    take_touched(window_, [&](std::uint64_t page, std::uint8_t) {
      touched[page] = 1;
      ask(page);
      for (unsigned axis = 0; axis < 3; ++axis) {
        ask(next_number(page, axis, last_page));
        ask(number_before(page, axis, last_page));
      }
    });
    for (const std::uint64_t page : to_ask) ask_page(page);
    room_.all_asked.insert(room_.all_asked.end(), to_ask.begin(), to_ask.end());
  } while (!to_ask.empty());
  for (std::size_t page = 0; page < touched.size(); ++page) {
    if (touched[page] != 0) window_.touched()[page] = 1;
  }
  for (const std::uint64_t page : room_.all_asked) std::fill_n(window_.asked() + page * 64, 64, 0);
}

template <class Point>
void DenseFan<Point>::ask_page(std::uint64_t page) {
  if (!room_.rays.may_cross(corner_of(page << ScanWindow::kPageCellBits), 16.0)) return;
  do {
    room_.found.clear();
    for (std::uint64_t brick = page * 64; brick < page * 64 + 64; ++brick) ask_brick(brick);
    walk(room_.found);
  } while (!room_.found.empty());
}

template <class Point>
void DenseFan<Point>::ask_brick(std::uint64_t brick) {
  const std::uint64_t all_bricks = (std::uint64_t{1} << (3 * window_.bits() - 6)) - 1;
  const auto marked = [&](std::uint64_t which) { return window_.missed()[which] | window_.hit()[which]; };
  std::uint64_t& asked = window_.asked()[brick];
  const std::uint64_t here = marked(brick), open = ~here & ~asked;
  if (open == 0) return;
  std::uint64_t border = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const BrickNeighbours& along = kAlong[axis];
    border |= along.ahead(here) | along.behind(here) | along.before_next(marked(next_number(brick, axis, all_bricks))) |
              along.after_last(marked(number_before(brick, axis, all_bricks)));
  }
  if ((border & open) == 0) return;
  asked |= room_.rays.take_some_across(corner_of(brick * 64), border & open, ends_m_, room_.found);
}

template <class Point>
Eigen::Vector3d DenseFan<Point>::corner_of(std::uint64_t place) const {
  const BasicKey<std::uint64_t> at = key_of_code(place);
  return Eigen::Vector3d(static_cast<double>(fan_.window_lowest[0] + static_cast<std::int64_t>(at.x)),
                         static_cast<double>(fan_.window_lowest[1] + static_cast<std::int64_t>(at.y)),
                         static_cast<double>(fan_.window_lowest[2] + static_cast<std::int64_t>(at.z))) -
         fan_.from;
}

template class DenseFan<Eigen::Vector3d>;
template class DenseFan<Eigen::Vector3f>;

}  // namespace pingvox::detail
