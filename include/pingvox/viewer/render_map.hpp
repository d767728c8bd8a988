#pragma once

#include <optional>

#include "pingvox/map/occupancy_map.hpp"
#include "pingvox/result.hpp"
#include "pingvox/viewer/picture.hpp"

namespace pingvox {

/// How colours are chosen: all differ in lightness, so that nobody needs to tell red from green.
struct MapColours {
  Rgb unknown{176, 182, 190};
  Rgb undecided{138, 146, 160};  ///< seen, but between the thresholds
  Rgb barely_free{226, 234, 244}, surely_free{255, 255, 255};
  Rgb barely_occupied{74, 96, 168}, surely_occupied{10, 16, 64};
};

/// Where one stands to look at a map. What is seen from above lies as on a chart, x (ahead) up and y (left) to the
/// left; seen from a side, z is up.
enum class MapView {
  kAbove,
  kRight,   ///< from the vehicle's right, x to the right
  kLeft,    ///< from its left, x to the left
  kFront,   ///< from before it, y to the right
  kBehind,  ///< from behind it, y to the left
};

struct MapPictureOptions {
  MapView view = MapView::kAbove;
  std::size_t target_px = 1000;                  ///< about as long is the longer side of what is known, 16..3072
  std::optional<double> min_z_m = std::nullopt;  ///< only what lies above, map frame
  std::optional<double> max_z_m = std::nullopt;  ///< only what lies below
  /// Only the layer of cells of the finest resolution that holds this height, instead of the two above.
  std::optional<double> layer_z_m = std::nullopt;
  std::optional<Box> at_least = std::nullopt;  ///< shown even where nothing is known, so that pictures can be compared
  MapColours colours{};

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The smallest box around the cells of a map that a picture shows; nullopt when there are none.
std::optional<Box> shown_part(const OccupancyMap& map, const MapPictureOptions& options);

/// A map seen from one of its sides: each line of cells along the look has the colour of its surest belief of being
/// occupied. A cell is a whole number of pixels; where the map is too large for that, a pixel is 2, 4, 8 ... cells wide
/// and shows the highest of them, so that no wall is lost. Around it axes in metres of the map frame, a scale bar, a
/// legend, and a cross at the origin of the map frame if that is in the picture.
/// REQUIRES valid options
Picture render_map(const OccupancyMap& map, const MapPictureOptions& options = {});

}  // namespace pingvox
