#include "viewer/map_paths.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/label.hpp"

namespace pingvox {
namespace {

struct PathStyle {
  Rgb colour;
  Marker marker;
};
/// Apart from the colours of maps; neighbours differ in lightness (L* 45, 70, 35, 61, 26), readable without colour.
constexpr std::array<PathStyle, MapPictureOptions::kMaxPaths> kPathStyles = {{{{206, 24, 60}, Marker::kDisc},
                                                                              {{40, 184, 140}, Marker::kSquare},
                                                                              {{140, 40, 140}, Marker::kTriangle},
                                                                              {{196, 132, 0}, Marker::kDiamond},
                                                                              {{100, 40, 0}, Marker::kCross}}};

constexpr double kPathWidth = 2.5, kMarkerRadius = 6.0, kEndRadius = 9.0;
constexpr std::ptrdiff_t kPathSwatch = 120;

void draw_heights_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t top, const PathHeights& heights) {
  constexpr std::ptrdiff_t kHigh = 18;
  for (std::ptrdiff_t i = 0; i < kPathSwatch; ++i) {
    const double share = static_cast<double>(i) / (kPathSwatch - 1);
    picture.fill(x + i, top, 1, kHigh, heights.colour_at(heights.low_m + share * (heights.high_m - heights.low_m)));
  }
  draw_frame(picture, {x, top, kPathSwatch, kHigh}, 1, kInk);
  draw_label(picture, x + kPathSwatch + 8, top + 2,
             fmt::format("path at z = {:.3g} to {:.3g} m", heights.low_m, heights.high_m), kTextScale, kInk);
}

void draw_path_marker(Picture& picture, Marker marker, Rgb colour, Spot at) {
  draw_marker(picture, marker, at, kMarkerRadius + 2.0, kPaper);
  draw_marker(picture, marker, at, kMarkerRadius, colour);
}

void draw_path_start(Picture& picture, const PathStyle& style, Spot at) {
  draw_disc(picture, at, kEndRadius + 1.0, kPaper);
  draw_marker(picture, Marker::kRing, at, kEndRadius, style.colour);
}

void draw_path_end(Picture& picture, const PathStyle& style, Spot at) {
  draw_disc(picture, at, kEndRadius + 1.0, kPaper);
  draw_disc(picture, at, kEndRadius, style.colour);
  draw_marker(picture, Marker::kCross, at, 0.55 * kEndRadius, kPaper);
}

/// The head of an arrow. REQUIRES a way that is no point.
void draw_path_arrow(Picture& picture, Rgb arrow_colour, Spot from, Spot to, const Area& within) {
  constexpr double kLength = 11.0, kHalfWidth = 6.0;
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  const double x = (to.x - from.x) / length, y = (to.y - from.y) / length;
  const Spot back{to.x - kLength * x, to.y - kLength * y};
  for (const auto& [width, colour] : {std::pair(kPathWidth + 2.0, kPaper), {kPathWidth, arrow_colour}}) {
    for (const double side : {-kHalfWidth, kHalfWidth}) {
      draw_line(picture, {back.x - side * y, back.y + side * x}, to, width, colour, within);
    }
  }
}

/// A line with a white edge, to be seen on walls as well. `spot_of` gives the place in the picture of a point in the
/// map.
/// @param heights  that colour it; nullopt: it has the colour of its style
void draw_path(Picture& picture, const Trajectory& path, const PathStyle& style,
               const std::optional<PathHeights>& heights, const Area& within,
               const std::function<Spot(const Eigen::Vector3d&)>& spot_of) {
  constexpr double kMarkerEvery = 160.0;  // pixels of the way
  struct Piece {
    Spot from, to;
    Rgb colour;
  };
  std::vector<Piece> pieces, arrows, markers;
  double way = 0.0;
  bool has_arrow = false;  // since the last marker
  const std::vector<StampedPose>& poses = path.poses();
  const auto is_inside = [&](Spot at) {
    return at.x >= static_cast<double>(within.x) && at.x < static_cast<double>(within.right()) &&
           at.y >= static_cast<double>(within.y) && at.y < static_cast<double>(within.bottom());
  };
  const Spot start = spot_of(poses.front().map_from_body.translation());
  Spot last = start;
  for (std::size_t n = 1; n < poses.size(); ++n) {
    const Eigen::Vector3d at_m = poses[n].map_from_body.translation();
    const Spot next = spot_of(at_m);
    const Rgb colour = heights ? heights->colour_at(at_m.z()) : style.colour;
    const bool is_gap = !path.at(0.5 * (poses[n - 1].time_s + poses[n].time_s));
    const double length = std::hypot(next.x - last.x, next.y - last.y);
    if (!is_gap && length < 1.0 && n + 1 < poses.size()) continue;
    if (!is_gap) {
      pieces.push_back({last, next, colour});
      way += length;
    }
    if (is_gap || way >= kMarkerEvery) {
      markers.push_back({last, next, colour});
      way = 0.0;
      has_arrow = false;
    } else if (!has_arrow && way >= 0.5 * kMarkerEvery && length > 0.0) {
      arrows.push_back({last, next, colour});
      has_arrow = true;
    }
    last = next;
  }
  for (const Piece& piece : pieces) draw_line(picture, piece.from, piece.to, kPathWidth + 2.0, kPaper, within);
  for (const Piece& piece : pieces) draw_line(picture, piece.from, piece.to, kPathWidth, piece.colour, within);
  for (const Piece& marker : markers) {
    if (is_inside(marker.to)) draw_path_marker(picture, style.marker, marker.colour, marker.to);
  }
  for (const Piece& arrow : arrows) draw_path_arrow(picture, arrow.colour, arrow.from, arrow.to, within);
  if (poses.size() > 1 && is_inside(last)) draw_path_end(picture, style, last);
  if (is_inside(start)) draw_path_start(picture, style, start);
}

}  // namespace

Rgb PathHeights::colour_at(double z_m) const {
  // Lighter the higher, readable without colour.
  constexpr Rgb kLow{96, 0, 112}, kMiddle{214, 40, 70}, kHigh{255, 186, 20};
  const double share = std::clamp((z_m - low_m) / (high_m - low_m), 0.0, 1.0);
  return share < 0.5 ? mix(kLow, kMiddle, 2.0 * share) : mix(kMiddle, kHigh, 2.0 * share - 1.0);
}

std::optional<PathHeights> heights_shown(const MapPictureOptions& options, double cell_m) {
  constexpr double kFewCells = 4.0;
  if (options.paths.size() != 1 || options.view != MapView::kAbove) return std::nullopt;
  const auto z_of = [](const StampedPose& pose) { return pose.map_from_body.translation().z(); };
  const std::vector<StampedPose>& poses = options.paths.front().map_from_body.poses();
  const auto [low, high] = std::ranges::minmax_element(poses, {}, z_of);
  const PathHeights heights{z_of(*low), z_of(*high)};
  if (!(heights.high_m - heights.low_m > kFewCells * cell_m)) return std::nullopt;
  return heights;
}

void draw_paths(Picture& picture, const std::vector<MapPath>& paths, const std::optional<PathHeights>& heights,
                const Area& within, const std::function<Spot(const Eigen::Vector3d&)>& spot_of) {
  for (std::size_t n = 0; n < paths.size(); ++n) {
    draw_path(picture, paths[n].map_from_body, kPathStyles[n], heights, within, spot_of);
  }
}

std::ptrdiff_t path_legend_rows(const std::vector<MapPath>& paths, const std::optional<PathHeights>& heights) {
  return static_cast<std::ptrdiff_t>(paths.size()) + (heights ? 1 : 0);
}

void draw_path_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t top, const std::vector<MapPath>& paths,
                      const std::optional<PathHeights>& heights) {
  constexpr std::string_view kStart = "start", kEnd = "end";
  for (std::size_t n = 0; n < paths.size(); ++n, top += kFooterRow) {
    const PathStyle& style = kPathStyles[n];
    const double middle = static_cast<double>(top) + 9.0;
    const std::ptrdiff_t line_x = x + label_width(kStart, kTextScale);
    draw_label(picture, x, top + 2, kStart, kTextScale, kInk);
    const Area row{line_x, top - kGap, kPathSwatch, kFooterRow};
    const auto spot = [&](double share) {
      return Spot{static_cast<double>(line_x) + share * static_cast<double>(kPathSwatch), middle};
    };
    draw_line(picture, spot(0.1), spot(0.9), kPathWidth, style.colour, row);
    draw_path_marker(picture, style.marker, style.colour, spot(0.4));
    draw_path_arrow(picture, style.colour, spot(0.1), spot(0.7), row);
    draw_path_start(picture, style, spot(0.1));
    draw_path_end(picture, style, spot(0.9));
    const std::ptrdiff_t end_x = line_x + kPathSwatch + kGap / 2;
    draw_label(picture, end_x, top + 2, fmt::format("{}: {}", kEnd, paths[n].name), kTextScale, kInk);
  }
  if (heights) draw_heights_legend(picture, x, top, *heights);
}

}  // namespace pingvox
