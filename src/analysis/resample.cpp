#include "pingvox/analysis/resample.hpp"

#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <new>
#include <optional>

#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

using Cell = Eigen::Matrix<std::int64_t, 3, 1>;  ///< counted from the centre of a lattice
using Key64 = BasicKey<std::uint64_t>;

/// Of a cell: so much of a neighbour may be overlapped by rounding alone.
constexpr double kRounding = 1e-6;

Cell floor_of(const Eigen::Vector3d& in_cells) {
  return in_cells.array().floor().cast<std::int64_t>();
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

  bool holds(const Cell& cell) const {
    return (cell.array() >= low.array()).all() && (cell.array() < low.array() + size).all();
  }
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

class Resampler {
 public:
  Resampler(const OccupancyMap& map, const Pose& to_from_map, OccupancyMap& out)
      : map_(map),
        out_(out),
        editor_(out.edit()),
        scale_(map.lattice().resolution_m() * out.lattice().cells_per_m()),
        to_from_map_(to_from_map.linear()),
        shift_(to_from_map.translation() * out.lattice().cells_per_m()),
        half_(0.5 / scale_ * to_from_map_.cwiseAbs().colwise().sum().transpose().array() - kRounding) {}

  void add(const Leaf& leaf) {
    const Cube cube = cube_of(leaf);
    const double edge = static_cast<double>(cube.size);
    const bool is_free = classify(leaf.belief, map_.options().thresholds) == Occupancy::kFree;
    const Eigen::Vector3d middle = to(cube.low.cast<double>().array() + 0.5 * edge);
    const Eigen::Vector3d reach = 0.5 * edge * scale_ * to_from_map_.cwiseAbs().rowwise().sum();
    const Cell low = (middle - reach).array().floor().cast<std::int64_t>();
    const Cell high = (middle + reach).array().floor().cast<std::int64_t>();
    for_each_cell(low, high, [&](const Cell& cell) {
      const Eigen::Vector3d from = this->from(cell.cast<double>().array() + 0.5);
      if (!cube.holds(floor_of(from))) return;
      if (!is_free) return put(cell, leaf.belief);
      if (const auto belief = free_around(from, cube, leaf.belief)) put(cell, *belief);
    });
    if (!is_free) add_points(cube, leaf.belief);
  }

 private:
  Eigen::Vector3d to(const Eigen::Vector3d& cells) const { return to_from_map_ * cells * scale_ + shift_; }
  Eigen::Vector3d from(const Eigen::Vector3d& cells) const {
    return to_from_map_.transpose() * (cells - shift_) / scale_;
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

  /// The least sure belief of the cells that a cell of the result overlaps; nullopt: one of them is not free.
  /// @param from    its middle, in cells of the map
  /// @param cube    where all has the belief `inside`
  std::optional<LogOdds> free_around(const Eigen::Vector3d& from, const Cube& cube, LogOdds inside) const {
    const Cell low = floor_of(from - half_), high = floor_of(from + half_);
    if (cube.holds(low) && cube.holds(high)) return inside;
    std::optional<LogOdds> least_sure = inside;
    for_each_cell(low, high, [&](const Cell& cell) {
      if (!least_sure || cube.holds(cell)) return;
      const auto belief = is_in(map_.lattice(), cell) ? map_.at(key_of_cell(map_.lattice(), cell)) : std::nullopt;
      const bool is_free = belief && classify(*belief, map_.options().thresholds) == Occupancy::kFree;
      least_sure = is_free ? std::optional(std::max(*least_sure, *belief)) : std::nullopt;
    });
    return least_sure;
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
  Eigen::Vector3d shift_;  ///< in cells of the result
  Eigen::Vector3d half_;   ///< of a cell of the result: half the box around it, in cells of the map
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
    return fail(
        Error::Code::kLimit,
        fmt::format("the map reaches farther than {:.6g} m from the origin, which is as far as {} levels of cells "
                    "of {:.6g} m go",
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
    Resampler resampler(map, to_from_map, *out);
    for_each_leaf(map, [&](const Leaf& leaf) { resampler.add(leaf); });
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
