#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pingvox/map/occupancy_map.hpp"

namespace pingvox::bench {

/// A box of cells of a lattice, each with what is known of it.
class CellGrid {
 public:
  using Cell = std::array<std::int64_t, 3>;

  explicit CellGrid(const Cell& size)
      : size_(size), classes_(static_cast<std::size_t>(size[0] * size[1] * size[2]), Occupancy::kUnknown) {}

  const Cell& size() const { return size_; }
  bool has(const Cell& c) const {
    return c[0] >= 0 && c[0] < size_[0] && c[1] >= 0 && c[1] < size_[1] && c[2] >= 0 && c[2] < size_[2];
  }
  Occupancy& at(const Cell& c) { return classes_[index(c)]; }
  Occupancy at(const Cell& c) const { return classes_[index(c)]; }

  /// Calls f(cell) for each, x fastest.
  template <class F>
  void for_each(F&& f) const {
    Cell c{};
    for (c[2] = 0; c[2] < size_[2]; ++c[2]) {
      for (c[1] = 0; c[1] < size_[1]; ++c[1]) {
        for (c[0] = 0; c[0] < size_[0]; ++c[0]) f(c);
      }
    }
  }

  /// Whether the cell or one that touches it (by face, edge or corner) is of a class.
  bool is_near(const Cell& c, Occupancy kind) const;

 private:
  std::size_t index(const Cell& c) const {
    return static_cast<std::size_t>(c[0] + size_[0] * (c[1] + size_[1] * c[2]));
  }
  Cell size_;
  std::vector<Occupancy> classes_;
};

/// Which cells of a lattice a grid holds: all that a box of space has a part in.
class CellBox {
 public:
  /// REQUIRES a box within the lattice, depth <= 16.
  CellBox(const Lattice& lattice, const Eigen::AlignedBox3d& box_m);
  /// The one layer of cells that holds `z_m`.
  static CellBox layer(const Lattice& lattice, Eigen::AlignedBox3d box_m, double z_m);

  CellGrid::Cell size() const;
  /// May lie outside of the grid; a point outside of the lattice does.
  CellGrid::Cell cell_of(const Eigen::Vector3d& point_m) const;
  /// kOccupied where a point lies, else kUnknown. A point in the face between two cells belongs to the upper one, with
  /// what rounding puts a hair below it.
  CellGrid mark(const std::vector<Eigen::Vector3d>& points_m) const;
  /// What a map of this lattice says of the cells, by its own thresholds or by others.
  CellGrid classes_of(const OccupancyMap& map) const { return classes_of(map, map.options().thresholds); }
  CellGrid classes_of(const OccupancyMap& map, const Thresholds& thresholds) const;

 private:
  Lattice lattice_;
  CellGrid::Cell low_{}, high_{};
};

}  // namespace pingvox::bench
