#include "pingvox/analysis/resample.hpp"

#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <optional>
#include <set>
#include <type_traits>
#include <vector>

#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

using Cell = Eigen::Matrix<std::int64_t, 3, 1>;  ///< counted from the centre of a lattice
using Key64 = BasicKey<std::uint64_t>;

/// Of a cell: so much of a neighbour may be overlapped by rounding alone.
constexpr double kRounding = 1e-6;

/// Without the function floor, which is called for each number on machines without SSE 4.
Cell floor_of(const Eigen::Vector3d& in_cells) {
  const Cell towards_zero = in_cells.cast<std::int64_t>();
  return towards_zero - (towards_zero.cast<double>().array() > in_cells.array()).cast<std::int64_t>().matrix();
}

std::int64_t half_of(const Lattice& lattice) {
  return std::int64_t{1} << (lattice.depth() - 1);
}

bool is_in(const Lattice& lattice, const Cell& cell) {
  return (cell.array() >= -half_of(lattice)).all() && (cell.array() < half_of(lattice)).all();
}

Key64 key_of_cell(const Lattice& lattice, const Cell& cell) {
  const auto word = [&](std::int64_t index) { return static_cast<std::uint64_t>(index + half_of(lattice)); };
  return {word(cell.x()), word(cell.y()), word(cell.z())};
}

/// A cube of cells: from `low`, `size` along each axis.
struct Cube {
  Cell low;
  std::int64_t size = 1;

  Cell end() const { return low.array() + size; }
};

Cube cube_of(const Leaf& leaf) {
  const auto index = [&](WideWord word) { return static_cast<std::int64_t>(word) - half_of(*leaf.lattice); };
  return {{index(leaf.key.x), index(leaf.key.y), index(leaf.key.z)},
          std::int64_t{1} << (leaf.lattice->depth() - leaf.depth)};
}

/// Visits the cells of a box, both corners included.
template <class Visit>
void for_each_cell(const Cell& low, const Cell& high, Visit&& visit) {
  for (Cell cell = low; cell.z() <= high.z(); ++cell.z()) {
    for (cell.y() = low.y(); cell.y() <= high.y(); ++cell.y()) {
      for (cell.x() = low.x(); cell.x() <= high.x(); ++cell.x()) visit(cell);
    }
  }
}

/// The nodes of a tree that overlap a box of cells, for a walk.
class InCells {
 public:
  /// @param end  beyond the last cell
  InCells(const Lattice& lattice, const Cell& low, const Cell& end)
      : levels_(lattice.depth()), low_(low.array() + half_of(lattice)), end_(end.array() + half_of(lattice)) {}

  bool overlaps(const Key64& key, int depth) const {
    if (depth < 0) return true;
    const Cell cell = cell_of(key);
    return (cell.array() < end_.array()).all() && (cell.array() + edge(depth) > low_.array()).all();
  }
  bool contains(const Key64& key, int depth) const {
    if (depth < 0) return false;
    const Cell cell = cell_of(key);
    return (cell.array() >= low_.array()).all() && (cell.array() + edge(depth) <= end_.array()).all();
  }

 private:
  static Cell cell_of(const Key64& key) {
    return {static_cast<std::int64_t>(key.x), static_cast<std::int64_t>(key.y), static_cast<std::int64_t>(key.z)};
  }
  std::int64_t edge(int depth) const { return std::int64_t{1} << (levels_ - depth); }

  int levels_;
  Cell low_, end_;  ///< as keys count
};

/// Visits the leaves that overlap a box of cells, as for_each_leaf does with a box in metres, but in whole numbers.
template <class Visit>
void for_each_leaf_in(const OccupancyMap& map, const Cell& low, const Cell& end, Visit&& visit) {
  const detail::TreeView tree = detail::view_of(map);
  const InCells where(map.lattice(), low, end);
  detail::LeafWalk<std::uint64_t, InCells, std::remove_reference_t<Visit>>(map, std::nullopt, where, visit)
      .visit(tree.root, Key64{}, -tree.extra_levels);
}

/// What is known of a box of cells, as an array: looked up faster than in the tree.
class CellWindow {
 public:
  /// @param end  beyond the last cell
  void load(const OccupancyMap& map, const Cell& low, const Cell& end) {
    low_ = low;
    size_ = end - low;
    beliefs_.assign(static_cast<std::size_t>(size_.prod()), std::numeric_limits<float>::quiet_NaN());
    for_each_leaf_in(map, low, end, [&](const Leaf& leaf) {
      const Cube cube = cube_of(leaf);
      const Cell from = cube.low.cwiseMax(low), to = cube.end().cwiseMin(end);
      for (std::int64_t z = from.z(); z < to.z(); ++z) {
        for (std::int64_t y = from.y(); y < to.y(); ++y) {
          std::fill_n(beliefs_.begin() + index_of({from.x(), y, z}), to.x() - from.x(), leaf.belief.value());
        }
      }
    });
  }

  /// NaN: unknown. REQUIRES a cell of the box.
  float at(const Cell& cell) const { return beliefs_[static_cast<std::size_t>(index_of(cell))]; }

  /// The greatest log-odds from `low` to `high`, both included; nullopt where one is not known or not below `limit`.
  std::optional<float> greatest_below(float limit, const Cell& low, const Cell& high) const {
    float greatest = std::numeric_limits<float>::lowest();
    for (std::int64_t z = low.z(); z <= high.z(); ++z) {
      for (std::int64_t y = low.y(); y <= high.y(); ++y) {
        const float* belief = beliefs_.data() + index_of({low.x(), y, z});
        for (std::int64_t x = low.x(); x <= high.x(); ++x, ++belief) {
          if (!(*belief < limit)) return std::nullopt;
          greatest = std::max(greatest, *belief);
        }
      }
    }
    return greatest;
  }

 private:
  std::ptrdiff_t index_of(const Cell& cell) const {
    const Cell from = cell - low_;
    return from.x() + size_.x() * (from.y() + size_.y() * from.z());
  }

  Cell low_ = Cell::Zero(), size_ = Cell::Zero();
  std::vector<float> beliefs_;
};

/// Finds what each cell of the result is, page by page of 16^3 cells.
class Resampler {
 public:
  Resampler(const OccupancyMap& map, const Pose& to_from_map, OccupancyMap& out)
      : map_(map),
        out_(out),
        editor_(out.edit()),
        scale_(map.lattice().resolution_m() * out.lattice().cells_per_m()),
        to_from_map_(to_from_map.linear()),
        map_from_to_(to_from_map.linear().transpose() / scale_),
        shift_(to_from_map.translation() * out.lattice().cells_per_m()),
        half_(0.5 / scale_ * to_from_map_.cwiseAbs().colwise().sum().transpose().array() - kRounding) {}

  void run() {
    for_each_leaf(map_, [&](const Leaf& leaf) { note_pages(cube_of(leaf)); });
    for (const auto& [z, y, x] : pages_) write_page(kPageEdge * Cell(x, y, z));
    for_each_leaf(map_, [&](const Leaf& leaf) {
      if (!is_free(leaf.belief)) add_points(cube_of(leaf), leaf.belief);
    });
  }

 private:
  static constexpr std::int64_t kPageEdge = 16, kBrickEdge = 4;
  /// In cells of the result to one of the map. In larger cells a page would need too large a window, and there are few.
  static constexpr double kMinScaleOfWindow = 0.2;
  using Brick = std::array<std::optional<LogOdds>, kBrickEdge * kBrickEdge * kBrickEdge>;

  bool is_free(LogOdds belief) const { return classify(belief, map_.options().thresholds) == Occupancy::kFree; }

  Eigen::Vector3d to(const Eigen::Vector3d& cells) const { return to_from_map_ * cells * scale_ + shift_; }
  Eigen::Vector3d from(const Eigen::Vector3d& cells) const { return map_from_to_ * (cells - shift_); }

  /// The pages of the result with cells whose middles may be in a cube.
  void note_pages(const Cube& cube) {
    const double edge = static_cast<double>(cube.size);
    const Eigen::Vector3d middle = to(cube.low.cast<double>().array() + 0.5 * edge);
    const Eigen::Vector3d reach = 0.5 * edge * scale_ * to_from_map_.cwiseAbs().rowwise().sum();
    const double page = static_cast<double>(kPageEdge);
    const Cell low = floor_of((middle - reach) / page), high = floor_of((middle + reach) / page);
    // Neighbours in the tree are mostly in the same pages.
    if (low == noted_low_ && high == noted_high_) return;
    noted_low_ = low;
    noted_high_ = high;
    for_each_cell(low, high, [&](const Cell& at) { pages_.insert({at.z(), at.y(), at.x()}); });
  }

  /// @param low  its lowest cell
  void write_page(const Cell& low) {
    if (uses_window_) {
      const double half_edge = 0.5 * static_cast<double>(kPageEdge);
      const Eigen::Vector3d middle = from(low.cast<double>().array() + half_edge);
      // A cell more than all that is looked up there.
      const Eigen::Vector3d reach =
          (half_edge / scale_ * to_from_map_.cwiseAbs().colwise().sum().transpose() + half_).array() + 1.0;
      window_.load(map_, floor_of(middle - reach), floor_of(middle + reach) + Cell::Ones());
    }
    constexpr std::int64_t kBricks = kPageEdge / kBrickEdge;
    for_each_cell(Cell::Zero(), Cell::Constant(kBricks - 1),
                  [&](const Cell& brick) { write_brick(low + kBrickEdge * brick); });
  }

  void write_brick(const Cell& low) {
    Brick beliefs;
    std::size_t place = 0;
    const Cell high = low.array() + (kBrickEdge - 1);
    for_each_cell(low, high, [&](const Cell& cell) { beliefs[place++] = belief_of(cell); });
    const int depth = out_.lattice().depth();
    constexpr int kLevelsOfBrick = 2;
    const bool is_uniform = std::ranges::all_of(beliefs, [&](const auto& one) { return one == beliefs.front(); });
    if (is_uniform && !beliefs.front()) return;
    if (is_uniform && depth >= kLevelsOfBrick) {
      editor_.set(key_of_cell(out_.lattice(), low), depth - kLevelsOfBrick, *beliefs.front());
      return;
    }
    place = 0;
    for_each_cell(low, high, [&](const Cell& cell) {
      const std::optional<LogOdds>& belief = beliefs[place++];
      if (belief) editor_.set(key_of_cell(out_.lattice(), cell), depth, *belief);
    });
  }

  /// Of a cell of the result, by the cell of the map that holds its middle. nullopt also where that is free, but not
  /// all that the cell overlaps.
  std::optional<LogOdds> belief_of(const Cell& cell) const {
    const Eigen::Vector3d middle = from(cell.cast<double>().array() + 0.5);
    const float belief = uses_window_ ? window_.at(floor_of(middle)) : belief_in_map(floor_of(middle));
    if (std::isnan(belief)) return std::nullopt;
    if (!is_free(LogOdds(belief))) return LogOdds(belief);
    const Cell low = floor_of(middle - half_), high = floor_of(middle + half_);
    // What is free is below the lower threshold.
    const auto least_sure = uses_window_ ? window_.greatest_below(map_.options().thresholds.lower.value(), low, high)
                                         : least_sure_of_leaves(low, high);
    return least_sure ? std::optional(LogOdds(*least_sure)) : std::nullopt;
  }

  float belief_in_map(const Cell& cell) const {
    const auto known = is_in(map_.lattice(), cell) ? map_.at(key_of_cell(map_.lattice(), cell)) : std::nullopt;
    return known ? known->value() : std::numeric_limits<float>::quiet_NaN();
  }

  /// As CellWindow::greatest_below of what is free, for a box of many cells.
  std::optional<float> least_sure_of_leaves(const Cell& low, const Cell& high) const {
    float least_sure = std::numeric_limits<float>::lowest();
    const Cell end = high + Cell::Ones();
    std::int64_t free = 0;
    for_each_leaf_in(map_, low, end, [&](const Leaf& leaf) {
      if (!is_free(leaf.belief)) return;
      const Cube cube = cube_of(leaf);
      free += (cube.end().cwiseMin(end) - cube.low.cwiseMax(low)).prod();
      least_sure = std::max(least_sure, leaf.belief.value());
    });
    return free == (end - low).prod() ? std::optional(least_sure) : std::nullopt;
  }

  /// Points of a cube that is not free, no farther apart than cells of the result: a wall may be thinner than these.
  void add_points(const Cube& cube, LogOdds belief) {
    const double edge = static_cast<double>(cube.size);
    const auto points = static_cast<std::int64_t>(std::max(1.0, std::ceil(edge * scale_ - kRounding)));
    const double apart = edge / static_cast<double>(points);
    for_each_cell(Cell::Zero(), Cell::Constant(points - 1), [&](const Cell& point) {
      put(floor_of(to(cube.low.cast<double>().array() + (point.cast<double>().array() + 0.5) * apart)), belief);
    });
  }

  void put(const Cell& cell, LogOdds belief) {
    const Key64 key = key_of_cell(out_.lattice(), cell);
    // Leaves are right while the editor is at work.
    if (const auto known = out_.at(key); known && *known >= belief) return;
    editor_.set(key, out_.lattice().depth(), belief);
  }

  const OccupancyMap& map_;
  const OccupancyMap& out_;
  Editor editor_;
  double scale_;  ///< cells of the result to one of the map
  Eigen::Matrix3d to_from_map_;
  Eigen::Matrix3d map_from_to_;  ///< its inverse, from cells of the result to those of the map
  Eigen::Vector3d shift_;        ///< in cells of the result
  Eigen::Vector3d half_;         ///< of a cell of the result: half the box around it, in cells of the map
  bool uses_window_ = scale_ >= kMinScaleOfWindow;
  CellWindow window_;                                          ///< of the page that is being written
  std::set<std::array<std::int64_t, 3>> pages_;                ///< z, y, x
  Cell noted_low_ = Cell::Ones(), noted_high_ = Cell::Zero();  ///< the last pages of note_pages
};

/// Whether all that is known finds its place in the other lattice.
Result<void> check_size(const OccupancyMap& map, const Pose& to_from_map, const Lattice& to) {
  double cells = 0.0;
  bool is_inside = true;
  for_each_leaf(map, [&](const Leaf& leaf) {
    const double edge = leaf.edge_m() * to.cells_per_m();
    cells += std::max(1.0, edge * edge * edge);
    const Eigen::Vector3d middle = to.in_cells(to_from_map * leaf.centre_m());
    const Eigen::Vector3d reach = 0.5 * edge * to_from_map.linear().cwiseAbs().rowwise().sum();
    const double half = static_cast<double>(half_of(to));
    is_inside = is_inside && ((middle - reach).array() >= -half).all() && ((middle + reach).array() < half).all();
  });
  if (!is_inside) {
    return fail(Error::Code::kLimit,
                fmt::format("the map reaches farther than {:.6g} m from the origin, the limit of {} levels with cells "
                            "of {:.6g} m",
                            static_cast<double>(half_of(to)) * to.resolution_m(), to.depth(), to.resolution_m()));
  }
  if (cells > static_cast<double>(kMaxResampledCells)) {
    return fail(Error::Code::kLimit, fmt::format("the map would have {:.3g} cells of {:.6g} m, more than {:.3g}", cells,
                                                 to.resolution_m(), static_cast<double>(kMaxResampledCells)));
  }
  return {};
}

}  // namespace

Result<OccupancyMap> resample(const OccupancyMap& map, const Pose& to_from_map, const MapOptions& to) {
  try {
    Result<OccupancyMap> out = OccupancyMap::make(to);
    if (!out) return out;
    const int depth = std::max(map.lattice().depth(), out->lattice().depth());
    if (depth > kMaxResampledDepth) {
      return fail(Error::Code::kUnsupported,
                  fmt::format("maps of up to {} levels can be moved, not of {}", kMaxResampledDepth, depth));
    }
    if (const auto fits = check_size(map, to_from_map, out->lattice()); !fits) return tl::unexpected(fits.error());
    Resampler(map, to_from_map, *out).run();
    return out;
  } catch (const std::bad_alloc&) {
    return fail(Error::Code::kNoMemory, "out of memory");
  }
}

Result<void> add_map(const OccupancyMap& other, const Pose& into_from_other, OccupancyMap& into) {
  if (into_from_other.matrix() == Pose::Identity().matrix() && other.lattice() == into.lattice())
    return into.merge(other);
  MapOptions options = into.options();
  options.thresholds = other.options().thresholds;
  return resample(other, into_from_other, options).and_then([&](const OccupancyMap& moved) {
    return into.merge(moved);
  });
}

}  // namespace pingvox
