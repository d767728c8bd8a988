#include "pingvox/analysis/map_agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/internal/cell_counts.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

constexpr std::uint64_t kMaxCount = std::numeric_limits<std::uint64_t>::max();

/// Cells from `first` to `last` along each axis, both included. REQUIRES at least one.
struct CellSpan {
  std::array<WideWord, 3> first, last;

  std::uint64_t cells() const {
    std::uint64_t product = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const WideWord steps = last[axis] - first[axis];
      if (steps >= WideWord{1} << 63) return kMaxCount;
      if (__builtin_mul_overflow(product, static_cast<std::uint64_t>(steps) + 1, &product)) return kMaxCount;
    }
    return product;
  }
};

std::optional<CellSpan> common(const CellSpan& a, const CellSpan& b) {
  CellSpan out{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.first[axis] = std::max(a.first[axis], b.first[axis]);
    out.last[axis] = std::min(a.last[axis], b.last[axis]);
    if (out.first[axis] > out.last[axis]) return std::nullopt;
  }
  return out;
}

template <KeyWord W>
CellSpan cells_of(const Lattice& lattice, const BasicKey<W>& key, int depth) {
  const int bits = lattice.depth() - depth;
  const WideWord steps = bits == 0 ? 0 : ~WideWord{0} >> (kMaxDepth - bits);
  const std::array<WideWord, 3> first = {key.x, key.y, key.z};
  return {first, {first[0] + steps, first[1] + steps, first[2] + steps}};
}

/// The cells with their middle in a box; nullopt: none.
std::optional<CellSpan> cells_in(const Lattice& lattice, const std::optional<Box>& box) {
  const CellSpan all = cells_of(lattice, WideKey{}, 0);
  if (!box) return all;
  CellSpan range = all;
  const double half = std::ldexp(1.0, lattice.depth() - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis);
    const double first = std::ceil(lattice.in_cells(box->min)[axis] - 0.5);
    const double last = std::floor(lattice.in_cells(box->max)[axis] - 0.5);
    if (!(first <= last && first < half && last >= -half)) return std::nullopt;
    if (first > -half) range.first[n] = static_cast<WideWord>(first + half);
    if (last < half - 1.0) range.last[n] = static_cast<WideWord>(last + half);
  }
  return range;
}

template <KeyWord W>
bool is_near(const OccupancyMap& map, const BasicKey<W>& key, Occupancy kind, std::uint32_t near_cells) {
  if (map.classify(key) == kind) return true;
  const WideWord last = ~WideWord{0} >> (kMaxDepth - map.lattice().depth()), reach = near_cells;
  const auto low = [reach](W word) { return static_cast<W>(word < reach ? 0 : word - reach); };
  const auto high = [last, reach](W word) { return static_cast<W>(last - word < reach ? last : word + reach); };
  for (W x = low(key.x);; ++x) {
    for (W y = low(key.y);; ++y) {
      for (W z = low(key.z);; ++z) {
        if (map.classify(BasicKey<W>{x, y, z}) == kind) return true;
        if (z == high(key.z)) break;
      }
      if (y == high(key.y)) break;
    }
    if (x == high(key.x)) break;
  }
  return false;
}

/// How many cells of a range are near one of a kind. REQUIRES few enough to visit each.
template <KeyWord W>
std::uint64_t count_near(const CellSpan& range, const OccupancyMap& to, Occupancy kind, std::uint32_t near_cells) {
  std::uint64_t near = 0;
  for (WideWord x = range.first[0];; ++x) {
    for (WideWord y = range.first[1];; ++y) {
      for (WideWord z = range.first[2];; ++z) {
        near += is_near(to, BasicKey<W>{static_cast<W>(x), static_cast<W>(y), static_cast<W>(z)}, kind, near_cells);
        if (z == range.last[2]) break;
      }
      if (y == range.last[1]) break;
    }
    if (x == range.last[0]) break;
  }
  return near;
}

/// Calls f(cells) for each occupied leaf of a map, as far as it lies in a range.
template <KeyWord W, class F>
void for_each_occupied(const OccupancyMap& map, const CellSpan& within, F&& f) {
  for_each_leaf(map, [&](const Leaf& leaf) {
    if (classify(leaf.belief, map.options().thresholds) != Occupancy::kOccupied) return;
    if (const auto cells = common(cells_of(map.lattice(), leaf.key, leaf.depth), within)) f(*cells);
  });
}

std::uint64_t occupied_cells(const OccupancyMap& map, const CellSpan& within) {
  std::uint64_t sum = 0;
  with_key_word(map.lattice().depth(), [&]<KeyWord W>() {
    for_each_occupied<W>(map, within, [&](const CellSpan& cells) { detail::add_saturated(sum, cells.cells()); });
  });
  return sum;
}

/// How many occupied cells of one map, within a range, are near one of the other's.
template <KeyWord W>
std::uint64_t occupied_near(const OccupancyMap& of, const OccupancyMap& to, const CellSpan& within,
                            std::uint32_t near_cells) {
  std::uint64_t near = 0;
  for_each_occupied<W>(
      of, within, [&](const CellSpan& cells) { near += count_near<W>(cells, to, Occupancy::kOccupied, near_cells); });
  return near;
}

/// Walks both trees at once: the time follows from their nodes, not from their cells.
class Walk {
 public:
  Walk(const OccupancyMap& a, const OccupancyMap& b, const CellSpan& within, std::uint32_t near_cells,
       MapAgreement& out)
      : a_(a.options().thresholds),
        b_(b.options().thresholds),
        map_b_(b),
        within_(within),
        near_cells_(near_cells),
        out_(out) {}

  void visit(const std::optional<NodeView>& a, const std::optional<NodeView>& b, const WideKey& key, int depth) {
    if (!a && !b) return;
    const std::optional<CellSpan> cells = common(cells_of(map_b_.lattice(), key, depth), within_);
    if (!cells) return;
    if ((!a || a->is_leaf()) && (!b || b->is_leaf())) {
      count(a ? classify(a->belief(), a_) : Occupancy::kUnknown, b ? classify(b->belief(), b_) : Occupancy::kUnknown,
            *cells);
      return;
    }
    const int bit = map_b_.lattice().depth() - 1 - depth;
    for (int octant = 0; octant < 8; ++octant) {
      const auto along = [&](WideWord word, int axis) { return word | WideWord(octant >> axis & 1) << bit; };
      visit(part(a, octant), part(b, octant), {along(key.x, 0), along(key.y, 1), along(key.z, 2)}, depth + 1);
    }
  }

  /// Of the cells that are free in A only, those near a free one of B; nullopt: too many to look around each.
  std::optional<std::uint64_t> near_free() const {
    return freed_only_by_a_ > MapAgreement::kMaxLookedAround ? std::nullopt : std::optional(near_free_);
  }

 private:
  static std::optional<NodeView> part(const std::optional<NodeView>& node, int octant) {
    return node && !node->is_leaf() ? node->child(octant) : node;
  }

  void count(Occupancy a, Occupancy b, const CellSpan& range) {
    const std::uint64_t cells = range.cells();
    if (a == Occupancy::kOccupied) detail::add_saturated(out_.occupied_a, cells);
    if (b == Occupancy::kOccupied) detail::add_saturated(out_.occupied_b, cells);
    if (a == Occupancy::kOccupied && b == a) detail::add_saturated(out_.occupied_both, cells);
    if (a == Occupancy::kFree) detail::add_saturated(out_.free_a, cells);
    if (b == Occupancy::kFree) detail::add_saturated(out_.free_b, cells);
    if (a == Occupancy::kFree && b == a) detail::add_saturated(out_.free_both, cells);
    if (a == Occupancy::kFree && b != a) look_around(range, cells);
  }

  void look_around(const CellSpan& range, std::uint64_t cells) {
    detail::add_saturated(freed_only_by_a_, cells);
    if (freed_only_by_a_ > MapAgreement::kMaxLookedAround) return;
    with_key_word(map_b_.lattice().depth(),
                  [&]<KeyWord W>() { near_free_ += count_near<W>(range, map_b_, Occupancy::kFree, near_cells_); });
  }

  Thresholds a_, b_;
  const OccupancyMap& map_b_;
  const CellSpan& within_;
  std::uint32_t near_cells_;
  MapAgreement& out_;
  std::uint64_t freed_only_by_a_ = 0, near_free_ = 0;
};

std::optional<double> share(const std::optional<std::uint64_t>& part, std::uint64_t whole) {
  if (!part || whole == 0) return std::nullopt;
  return static_cast<double>(*part) / static_cast<double>(whole);
}

std::optional<Box> bounds_of_free(const OccupancyMap& map) {
  std::optional<Box> bounds;
  for_each_leaf(map, [&](const Leaf& leaf) {
    if (classify(leaf.belief, map.options().thresholds) != Occupancy::kFree) return;
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * leaf.edge_m());
    if (!bounds) bounds = Box{leaf.centre_m(), leaf.centre_m()};
    bounds->min = bounds->min.cwiseMin(leaf.centre_m() - half);
    bounds->max = bounds->max.cwiseMax(leaf.centre_m() + half);
  });
  return bounds;
}

/// Whether all of the free leaves that reach farthest to one side have an occupied cell behind them.
bool has_wall(const OccupancyMap& map, const Box& bounds_of_free, int axis, double side) {
  const double half_cell_m = 0.5 * map.lattice().resolution_m();
  const double face_m = side < 0.0 ? bounds_of_free.min[axis] : bounds_of_free.max[axis];
  Box outermost = bounds_of_free;
  outermost.min[axis] = std::min(face_m, face_m - side * half_cell_m);
  outermost.max[axis] = std::max(face_m, face_m - side * half_cell_m);
  bool is_open = false;
  for_each_leaf(map, {.max_depth = {}, .box = outermost}, [&](const Leaf& leaf) {
    if (is_open || classify(leaf.belief, map.options().thresholds) != Occupancy::kFree) return;
    const Eigen::Vector3d behind_m =
        leaf.centre_m() + side * (0.5 * leaf.edge_m() + half_cell_m) * Eigen::Vector3d::Unit(axis);
    is_open = map.classify(behind_m) != Occupancy::kOccupied;
  });
  return !is_open;
}

}  // namespace

std::optional<double> MapAgreement::precision() const {
  return share(a_near_b, occupied_a);
}
std::optional<double> MapAgreement::recall() const {
  return share(found_by_a, to_find);
}
std::optional<double> MapAgreement::free_true() const {
  return share(free_both, free_a);
}
std::optional<double> MapAgreement::free_true_near() const {
  return share(free_near, free_a);
}

MapAgreement agreement_of(const OccupancyMap& a, const OccupancyMap& b, const AgreementOptions& options) {
  assert(a.lattice() == b.lattice() && (options.visible == nullptr || options.visible->lattice() == a.lattice()));
  MapAgreement out;
  const std::optional<CellSpan> within = cells_in(a.lattice(), options.box);
  if (!within) return out;
  Walk walk(a, b, *within, options.near_cells, out);
  walk.visit(a.root(), b.root(), {}, 0);
  const OccupancyMap& to_find = options.visible != nullptr ? *options.visible : b;
  out.to_find = options.visible != nullptr ? occupied_cells(to_find, *within) : out.occupied_b;
  if (const auto near = walk.near_free()) out.free_near = out.free_both + *near;
  if (out.occupied_a > MapAgreement::kMaxLookedAround || out.to_find > MapAgreement::kMaxLookedAround) return out;
  with_key_word(a.lattice().depth(), [&]<KeyWord W>() {
    out.a_near_b = occupied_near<W>(a, b, *within, options.near_cells);
    out.found_by_a = occupied_near<W>(to_find, a, *within, options.near_cells);
  });
  return out;
}

OccupancyMap with_thresholds(const OccupancyMap& map, const Thresholds& thresholds) {
  MapOptions options = map.options();
  options.thresholds = thresholds;
  OccupancyMap out(options);
  Editor editor = out.edit();
  for_each_leaf(map, [&](const Leaf& leaf) { editor.set(leaf.key, leaf.depth, leaf.belief); });
  editor.synchronize();
  return out;
}

std::optional<Box> judged_box(const OccupancyMap& truth, double behind_m) {
  const std::optional<Box> bounds = truth.bounds();
  if (!bounds) return std::nullopt;
  const std::optional<Box> free = bounds_of_free(truth);
  Box box{bounds->min.array() - behind_m, bounds->max.array() + behind_m};
  for (int axis = 0; free && axis < 3; ++axis) {
    if (!has_wall(truth, *free, axis, -1.0)) box.min[axis] = free->min[axis];
    if (!has_wall(truth, *free, axis, 1.0)) box.max[axis] = free->max[axis];
  }
  return box;
}

}  // namespace pingvox
