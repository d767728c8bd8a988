#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// Which cells a convex body touches, many rows of cells at a time. Cells are those of a grid of edge 1, counted from
/// the one that the origin is in; axes are those of the walk: of layers, of rows in a layer, of cells in a row.
namespace pingvox::detail {

/// Of a layer, of a row, along a row.
struct WalkAxes {
  double layer = 0.0, row = 0.0, cell = 0.0;
};

/// The half-space normal * p >= 0, for whole cells: one with its middle at c touches it when normal * c >= -reach.
struct Face {
  WalkAxes normal;
  double row_way = 0.0, cell_way = 0.0;  ///< 1 / normal.row, 1 / normal.cell
  double reach = 0.0;
  double max_along_row = 0.0;  ///< maximum of normal.cell times a place within the box
};

/// Intersection of five half-spaces through the origin, a sphere around it and a box.
struct ConvexBody {
  std::array<Face, 5> faces;
  double range = 0.0;  ///< radius of the sphere
  WalkAxes in_cell;    ///< the origin in its cell, each component in [0, 1)
  WalkAxes low, high;  ///< corners of the box; cells count by their middles
};

/// Rounding must not decide whether a face, or the sphere along a row, touches a cell [cells].
inline constexpr double kGrazing = 1e-9;

/// The rows first..last of some layers, as whole numbers; none where first > last.
struct RowsOfLayers {
  static constexpr std::size_t kLayers = 16;
  std::array<double, kLayers> first, last;
};

/// Finds the rows of 16 layers that touch all half-spaces somewhere.
void find_rows(const ConvexBody& body, std::int64_t first_layer, RowsOfLayers& rows);

/// Four rows of each of four layers: row r of layer l is number 4 * l + r.
struct ColumnOfRows {
  static constexpr std::size_t kRows = 16;
  std::int64_t first_layer = 0, first_row = 0;
  const double *first_of_layer = nullptr, *last_of_layer = nullptr;  ///< rows that count, of each layer
  std::int64_t lowest_cell = 0;                                      ///< gets the place 0
  std::int64_t no_place = 0;  ///< begin of rows without cells, beyond all places; their end is 0
};
/// The cells begin..end-1 of each row, as places in the column.
struct RunsOfRows {
  std::array<std::int64_t, ColumnOfRows::kRows> begin, end;
  std::int64_t lowest_begin, highest_end;
};

/// Finds the cells of rows that touch all half-spaces and the sphere.
void find_cells(const ConvexBody& body, const ColumnOfRows& column, RunsOfRows& runs);

}  // namespace pingvox::detail
