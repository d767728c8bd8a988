#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/cell_agreement.hpp"
#include "pingvox/map/map_axes.hpp"
#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "pingvox/viewer/picture.hpp"

namespace pingvox {

/// Colours of a map. All differ in lightness, to be readable without colour.
struct MapColours {
  Rgb unknown{176, 182, 190};
  Rgb undecided{138, 146, 160};  ///< known, but between the thresholds
  Rgb barely_free{226, 234, 244}, surely_free{255, 255, 255};
  Rgb barely_occupied{74, 96, 168}, surely_occupied{10, 16, 64};
  // Of occupied cells, where agreement is shown.
  Rgb not_judged{110, 114, 120};
  Rgb none_agree{240, 120, 0}, all_agree{16, 40, 120};
};

/// Viewpoint. From above, what `MapPictureOptions::axes` say is up; from a side, z is up.
enum class MapView {
  kAbove,
  kRight,   ///< from the right side, x to the right
  kLeft,    ///< from the left side, x to the left
  kFront,   ///< from ahead, y to the right
  kBehind,  ///< from behind, y to the left
};

/// A trajectory in the frame of a map, and its name in the legend (ASCII).
struct MapPath {
  std::string name;
  Trajectory map_from_body;
};

struct MapPictureOptions {
  /// Paths that have colours of their own.
  static constexpr std::size_t kMaxPaths = 5;

  MapView view = MapView::kAbove;
  /// Of the map. From above, x is up and y left (ahead and left of the vehicle) where they are not told; else y is up
  /// and x right, with an arrow that points north where that is known.
  MapAxes axes = MapAxes::kUnknown;
  std::size_t target_px = 1000;                  ///< approximate length of the longer side of the known part, 16..3072
  std::optional<double> min_z_m = std::nullopt;  ///< only cells above, map frame
  std::optional<double> max_z_m = std::nullopt;  ///< only cells below
  /// Only the layer of finest cells at this height; replaces the two above.
  std::optional<double> layer_z_m = std::nullopt;
  std::optional<Box> at_least = std::nullopt;  ///< always shown, so that pictures can be compared
  std::vector<MapPath> paths{};                ///< drawn over the map; at most kMaxPaths
  /// How echoes agree with cells of the map (Evaluation::cells): the colour of occupied columns is the share that
  /// agrees with the occupied cells in them. nullopt: it shows how certain they are.
  std::optional<std::vector<CellAgreement>> agreement = std::nullopt;
  MapColours colours{};

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Bounding box of the cells and paths that a picture shows; nullopt when there are no cells.
std::optional<Box> shown_part(const OccupancyMap& map, const MapPictureOptions& options);

/// A map projected along one axis: each column of cells has the colour of its highest occupancy. A cell is a whole
/// number of pixels; if the map is too large for that, a pixel is 2, 4, 8 ... cells wide and shows their maximum, so
/// that no wall is lost. Paths have marks at their start and end, and along them markers and arrows; a single one whose
/// height changes by more than four cells is coloured by it in pictures from above. With axes in metres (map frame), a
/// scale bar, a legend, and a cross at the origin of the map frame. REQUIRES valid options
Picture render_map(const OccupancyMap& map, const MapPictureOptions& options = {});

}  // namespace pingvox
