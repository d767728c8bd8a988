#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pingvox/map/log_odds.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Which part of a map, and how far distances go.
struct DistanceFieldOptions {
  double min_z_m = -0.5, max_z_m = 0.5;  ///< heights of the layer, map frame; finite, min below max
  double truncation_m = 1.0;             ///< > 0; cut to 64 cells of the map

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Horizontal distance to the nearest occupied cell, for each column of cells in a layer of a map, with what is known
/// of the column. A column is occupied when any of its cells in the layer is, free when one is and none is occupied,
/// else unknown. In tiles of 64 x 64 columns; where nothing is known there are none.
class DistanceField {
 public:
  static constexpr std::int64_t kTile = 64;
  /// The value of a column: its distance in steps of truncation_m() / kFar (kFar: that or more), plus kUnknown where it
  /// is unknown.
  static constexpr std::uint8_t kFar = 127, kUnknown = 128;

  /// @return kBadOption for invalid options; kUnsupported when nothing is occupied in the layer; kLimit when the layer
  ///         is too large: 2^14 tiles, or a box of 2^22 around them
  static Result<DistanceField> make(const OccupancyMap& map, const DistanceFieldOptions& options);

  double truncation_m() const { return truncation_m_; }
  double cell_m() const { return cell_m_; }
  std::size_t memory_bytes() const { return values_.size() + clear_cells_.size() + tiles_.size() * sizeof(tiles_[0]); }

  /// Value of the column that holds a point [m, map frame]. Outside, or NaN: kFar + kUnknown.
  std::uint8_t value_at(double x_m, double y_m) const {
    const double x = x_m * cells_per_m_ - first_x_, y = y_m * cells_per_m_ - first_y_;
    if (!(x >= 0.0 && x < size_x_ && y >= 0.0 && y < size_y_)) return kFar + kUnknown;
    const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
    const std::size_t tile = tiles_[(j / kTile) * tiles_x_ + i / kTile];
    return values_[(tile * kTile + j % kTile) * kTile + i % kTile];
  }
  /// Between the middles of the column and of the nearest occupied one [m], at most truncation_m(); to half a step.
  double distance_m(const Eigen::Vector2d& point_m) const {
    return step_m_ * (value_at(point_m.x(), point_m.y()) & kFar);
  }
  Occupancy classify(const Eigen::Vector2d& point_m) const;

  /// How far one can go before an occupied column is met [m]; limit_m when there is none before.
  /// @param direction  of length 1
  double clear_range_m(const Eigen::Vector2d& from_m, const Eigen::Vector2d& direction, double limit_m) const;

  /// The places of a square grid where a vehicle may be [m]: not occupied, and free itself or with a free column within
  /// `reach_m` (a sonar that stands still leaves unknown what is nearer than its blanking range). Each is the middle of
  /// a column. In order of tiles, then rows. REQUIRES step_m > 0
  std::vector<Eigen::Vector2d> places(double step_m, double reach_m) const;
  /// The middles of the occupied columns [m]. In order of tiles, then rows.
  std::vector<Eigen::Vector2d> occupied() const;
  /// Free columns times their area [m^2].
  double free_area_m2() const;

 private:
  DistanceField() = default;

  static constexpr std::size_t kBlocks = 8;  ///< along a side of a tile
  static std::size_t block_of(std::size_t tile, std::size_t x, std::size_t y) {
    return (tile * kBlocks + y * kBlocks / kTile) * kBlocks + x * kBlocks / kTile;
  }
  /// How far nothing is occupied around a point, at least [m]; 0 outside.
  double clear_m(const Eigen::Vector2d& point_m) const;

  double cell_m_ = 0.0, cells_per_m_ = 0.0, truncation_m_ = 0.0, step_m_ = 0.0;
  double first_x_ = 0.0, first_y_ = 0.0;  ///< column at the lowest corner, in cells from the centre of the lattice
  double size_x_ = 0.0, size_y_ = 0.0;    ///< in cells
  std::size_t tiles_x_ = 0;
  std::vector<std::uint32_t> tiles_;  ///< by row: index of a tile; 0: nothing is known, all is far
  std::vector<std::uint8_t> values_;  ///< tile by tile, row by row
  /// By block of columns, in the same order: how many cells nothing is occupied around any point of it.
  std::vector<std::uint8_t> clear_cells_;
};

}  // namespace pingvox
