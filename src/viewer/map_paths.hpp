#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "pingvox/viewer/picture.hpp"
#include "pingvox/viewer/render_map.hpp"
#include "viewer/strokes.hpp"

/// Paths drawn over a map.
namespace pingvox {

/// Heights of a path that is coloured by them.
struct PathHeights {
  double low_m, high_m;

  Rgb colour_at(double z_m) const;
};

/// Of the only path, where they differ by more than some cells, and the picture does not show them anyway.
std::optional<PathHeights> heights_shown(const MapPictureOptions& options, double cell_m);

/// @param heights   that colour them; nullopt: each has a colour of its own
/// @param spot_of   the place in the picture of a point in the map
void draw_paths(Picture& picture, const std::vector<MapPath>& paths, const std::optional<PathHeights>& heights,
                const Area& within, const std::function<Spot(const Eigen::Vector3d&)>& spot_of);

/// Rows of kFooterRow that the legend takes.
std::ptrdiff_t path_legend_rows(const std::vector<MapPath>& paths, const std::optional<PathHeights>& heights);
void draw_path_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t top, const std::vector<MapPath>& paths,
                      const std::optional<PathHeights>& heights);

}  // namespace pingvox
