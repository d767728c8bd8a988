#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "pingvox/geometry/key.hpp"
#include "pingvox/geometry/lattice.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/viewer/render_map.hpp"

/// A map seen along one of its axes: what its columns of cells hold.
namespace pingvox {

/// Axes of the map frame (0 x, 1 y, 2 z) that are horizontal and vertical in the picture; vertical always grows
/// upwards.
struct ViewAxes {
  std::size_t across, up;
  enum class Across { kGrowsRightwards, kGrowsLeftwards } grows;
  std::string_view note;
};

ViewAxes view_axes(const MapPictureOptions& options);

/// Lower and upper height of the layer of cells at `z_m`; nullopt outside of the lattice.
std::optional<std::pair<double, double>> layer_at(const Lattice& lattice, double z_m);

/// Log-odds of a column of which nothing is known.
inline constexpr float kNoCell = -std::numeric_limits<float>::infinity();

/// Maximum log-odds of each column of cells along the view. (0, 0) is the lowest cell; kNoCell is unknown.
struct MapColumns {
  std::size_t across = 0, up = 0;  ///< how many
  double cell_m = 0.0;
  double least_across_m = 0.0, least_up_m = 0.0;
  WideWord first_across = 0, first_up = 0;  ///< key components of the lowest column, shifted
  int shift = 0;                            ///< levels that a column is larger than a cell
  std::vector<float> belief;

  float at(std::size_t a, std::size_t u) const { return belief[u * across + a]; }
};

/// Columns of the shown part, at most `most` along each side.
MapColumns columns_of(const OccupancyMap& map, const MapPictureOptions& options, std::size_t most);

/// How echoes agree with the occupied cells of a column.
struct ColumnAgreement {
  std::size_t judged = 0, agreed = 0;
};

/// Of each column of a picture. REQUIRES options with an agreement.
std::vector<ColumnAgreement> agreement_of(const OccupancyMap& map, const MapPictureOptions& options,
                                          const ViewAxes& axes, const MapColumns& columns);

}  // namespace pingvox
