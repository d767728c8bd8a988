#include "pingvox/viewer/render_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "base/option_errors.hpp"
#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/label.hpp"
#include "viewer/map_columns.hpp"
#include "viewer/map_paths.hpp"
#include "viewer/strokes.hpp"

namespace pingvox {
namespace {

constexpr std::ptrdiff_t kNote = 26, kBorder = 2;
constexpr std::ptrdiff_t kMinMapWidth = 480;  ///< room for scale bar and legend
constexpr Rgb kCross{230, 120, 0};

/// Position of `belief` between `from` (0) and `to` (1).
double share_of(LogOdds belief, LogOdds from, LogOdds to) {
  const double way = static_cast<double>(to.value()) - static_cast<double>(from.value());
  if (!(std::fabs(way) > 0.0)) return 1.0;
  return std::clamp((static_cast<double>(belief.value()) - static_cast<double>(from.value())) / way, 0.0, 1.0);
}

Rgb colour_of(float belief, const MapOptions& map, const MapColours& colours) {
  if (belief == kNoCell) return colours.unknown;
  switch (classify(LogOdds(belief), map.thresholds)) {
    case Occupancy::kOccupied:
      return mix(colours.barely_occupied, colours.surely_occupied,
                 share_of(LogOdds(belief), map.thresholds.upper, map.clamp.highest));
    case Occupancy::kFree:
      return mix(colours.barely_free, colours.surely_free,
                 share_of(LogOdds(belief), map.thresholds.lower, map.clamp.lowest));
    case Occupancy::kUnknown:
      break;
  }
  return colours.undecided;
}

/// Colour of an occupied column by how echoes agree with it.
Rgb colour_of(const ColumnAgreement& column, const MapColours& colours) {
  if (column.judged == 0) return colours.not_judged;
  return mix(colours.none_agree, colours.all_agree,
             static_cast<double>(column.agreed) / static_cast<double>(column.judged));
}

/// An orange cross with a dark edge, visible on light and dark cells.
void draw_cross(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y) {
  constexpr std::ptrdiff_t kArm = 11;
  picture.fill(x - kArm - 1, y - 2, 2 * kArm + 3, 5, kPaper);
  picture.fill(x - 2, y - kArm - 1, 5, 2 * kArm + 3, kPaper);
  picture.fill(x - kArm, y - 1, 2 * kArm + 1, 3, kCross);
  picture.fill(x - 1, y - kArm, 3, 2 * kArm + 1, kCross);
}

void draw_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t top, const MapOptions& map,
                 const MapPictureOptions& options) {
  const MapColours& colours = options.colours;
  constexpr std::ptrdiff_t kSwatch = 32, kHigh = 18;
  struct Entry {
    std::string_view text;
    Rgb from, to;
  };
  std::vector<Entry> legend = {{"free", colours.barely_free, colours.surely_free},
                               {"unknown", colours.unknown, colours.unknown}};
  if (!options.agreement) legend.insert(legend.begin(), {"occupied", colours.barely_occupied, colours.surely_occupied});
  if (map.thresholds.lower < map.thresholds.upper) {
    legend.push_back({"between", colours.undecided, colours.undecided});
  }
  for (const Entry& entry : legend) {
    for (std::ptrdiff_t i = 0; i < kSwatch; ++i) {
      picture.fill(x + i, top, 1, kHigh, mix(entry.from, entry.to, static_cast<double>(i) / (kSwatch - 1)));
    }
    draw_frame(picture, {x, top, kSwatch, kHigh}, 1, kInk);
    draw_label(picture, x + kSwatch + 8, top + 2, entry.text, kTextScale, kInk);
    x += kSwatch + 8 + label_width(entry.text, kTextScale) + 16;
  }
}

/// What the colours of occupied cells say where agreement is shown.
void draw_agreement_legend(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t top, const MapColours& colours) {
  constexpr std::string_view kJudged = "0 to 100 % agree", kNotJudged = "not judged";
  constexpr std::ptrdiff_t kRamp = 120, kSwatch = 32, kHigh = 18;
  for (std::ptrdiff_t i = 0; i < kRamp; ++i) {
    picture.fill(x + i, top, 1, kHigh,
                 mix(colours.none_agree, colours.all_agree, static_cast<double>(i) / (kRamp - 1)));
  }
  draw_frame(picture, {x, top, kRamp, kHigh}, 1, kInk);
  x += kRamp + 8;
  draw_label(picture, x, top + 2, kJudged, kTextScale, kInk);
  x += label_width(kJudged, kTextScale) + 16;
  picture.fill(x, top, kSwatch, kHigh, colours.not_judged);
  draw_frame(picture, {x, top, kSwatch, kHigh}, 1, kInk);
  draw_label(picture, x + kSwatch + 8, top + 2, kNotJudged, kTextScale, kInk);
}

/// An arrow to the north in the upper right corner of an area whose north is up.
void draw_north(Picture& picture, const Area& area) {
  constexpr std::ptrdiff_t kWide = 34, kHigh = 66, kApart = 10;
  constexpr double kLine = 2.5;
  const Area patch{area.right() - kWide - kApart, area.y + kApart, kWide, kHigh};
  picture.fill(patch.x, patch.y, patch.width, patch.height, kPaper);
  draw_frame(picture, patch, 1, kInk);
  const double middle = static_cast<double>(patch.x) + 0.5 * kWide;
  const Spot tip{middle, static_cast<double>(patch.y) + 6.0};
  draw_line(picture, {middle, tip.y + 34.0}, tip, kLine, kInk, patch);
  for (const double side : {-7.0, 7.0}) draw_line(picture, {middle + side, tip.y + 12.0}, tip, kLine, kInk, patch);
  draw_centred(picture, std::lround(middle), patch.bottom() - 22, "N", kInk);
}

/// Caption: which part of the map is shown.
std::string note_of(const OccupancyMap& map, const MapPictureOptions& options, const ViewAxes& axes) {
  if (!options.layer_z_m) return std::string(axes.note);
  const auto layer = layer_at(map.lattice(), *options.layer_z_m);
  if (!layer) return fmt::format("z = {:.6g} m, outside of the map", *options.layer_z_m);
  // Rounds tiny values to 0.
  const auto tidy = [&](double z_m) { return std::abs(z_m) < 1e-6 * map.lattice().resolution_m() ? 0.0 : z_m; };
  return fmt::format("{}, layer z = {:.6g} to {:.6g} m", axes.note, tidy(layer->first), tidy(layer->second));
}

/// Where the columns of a map are drawn: in an area that is wider by a margin of unknown, which shows their outline.
struct MapLayout {
  std::ptrdiff_t zoom = 1;                           ///< edge of a column [px]
  std::ptrdiff_t width = 0, height = 0;              ///< of the area [px]
  std::ptrdiff_t columns_left = 0, columns_top = 0;  ///< upper left corner of the columns in the area [px]
  bool is_mirrored = false;                          ///< the first column is at the right
  double metres_per_pixel = 0.0;
  AxisScale across = {}, up = {};  ///< of the area
};

MapLayout layout_of(const MapColumns& columns, const ViewAxes& axes, std::size_t target_px) {
  const std::size_t longer = std::max({columns.across, columns.up, std::size_t{1}});
  // Up to 15% larger than requested rather than half as large; a single cell need not fill the picture.
  const auto zoom = static_cast<std::ptrdiff_t>(std::clamp<std::size_t>(target_px * 23 / 20 / longer, 1, 64));
  const std::ptrdiff_t halo = std::max<std::ptrdiff_t>(zoom, 8);
  const std::ptrdiff_t columns_width = static_cast<std::ptrdiff_t>(columns.across) * zoom;
  MapLayout layout{.zoom = zoom,
                   .width = std::max(columns_width + 2 * halo, kMinMapWidth),
                   .height = static_cast<std::ptrdiff_t>(columns.up) * zoom + 2 * halo,
                   .columns_top = halo,
                   .is_mirrored = axes.grows == ViewAxes::Across::kGrowsLeftwards,
                   .metres_per_pixel = columns.cell_m / static_cast<double>(zoom)};
  layout.columns_left = (layout.width - columns_width) / 2;
  const auto metres = [&](std::ptrdiff_t pixels) { return static_cast<double>(pixels) * layout.metres_per_pixel; };
  const std::ptrdiff_t columns_right = layout.width - layout.columns_left - columns_width;
  const double before_m = columns.least_across_m - metres(layout.is_mirrored ? columns_right : layout.columns_left);
  const double behind_m = before_m + metres(layout.width);
  layout.across = layout.is_mirrored ? AxisScale{behind_m, before_m} : AxisScale{before_m, behind_m};
  const double bottom_m = columns.least_up_m - metres(halo);
  layout.up = {bottom_m, bottom_m + metres(layout.height)};
  return layout;
}

void draw_columns(Picture& picture, const OccupancyMap& map, const MapPictureOptions& options,
                  const MapColumns& columns, const MapLayout& layout, const Area& area) {
  const std::vector<ColumnAgreement> agreement =
      options.agreement ? agreement_of(map, options, view_axes(options), columns) : std::vector<ColumnAgreement>();
  const std::ptrdiff_t zoom = layout.zoom;
  for (std::size_t a = 0; a < columns.across; ++a) {
    const auto right = static_cast<std::ptrdiff_t>(layout.is_mirrored ? columns.across - 1 - a : a);
    for (std::size_t u = 0; u < columns.up; ++u) {
      const float belief = columns.at(a, u);
      const bool shows_agreement = options.agreement && belief != kNoCell &&
                                   classify(LogOdds(belief), map.options().thresholds) == Occupancy::kOccupied;
      const Rgb colour = shows_agreement ? colour_of(agreement[u * columns.across + a], options.colours)
                                         : colour_of(belief, map.options(), options.colours);
      const auto down = static_cast<std::ptrdiff_t>(columns.up - 1 - u);
      picture.fill(area.x + layout.columns_left + right * zoom, area.y + layout.columns_top + down * zoom, zoom, zoom,
                   colour);
    }
  }
}

}  // namespace

Result<void> MapPictureOptions::validate() const {
  OptionErrors errors;
  errors.require("target_px", target_px, kPictureSizes_px);
  if ((min_z_m && std::isnan(*min_z_m)) || (max_z_m && std::isnan(*max_z_m)) ||
      (min_z_m && max_z_m && *min_z_m >= *max_z_m)) {
    errors.add("min_z_m must be below max_z_m");
  }
  if (layer_z_m && !std::isfinite(*layer_z_m)) errors.add("layer_z_m must be finite");
  if (layer_z_m && (min_z_m || max_z_m)) errors.add("a layer has no min_z_m and max_z_m of its own");
  if (paths.size() > kMaxPaths) errors.add(fmt::format("paths: at most {}, are {}", kMaxPaths, paths.size()));
  return errors.result("map picture");
}

Picture render_map(const OccupancyMap& map, const MapPictureOptions& options) {
  assert(options.validate());
  const ViewAxes axes = view_axes(options);
  const MapColumns columns = columns_of(map, options, options.target_px);
  const MapLayout layout = layout_of(columns, axes, options.target_px);
  const auto ticks_on = [](std::ptrdiff_t pixels) {
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(pixels / 80, 4, 12));
  };
  const std::vector<Tick> across_ticks = ticks_of(layout.across, ticks_on(layout.width));
  const std::vector<Tick> up_ticks = ticks_of(layout.up, ticks_on(layout.height));

  const std::optional<PathHeights> heights = heights_shown(options, map.lattice().resolution_m());
  const std::ptrdiff_t legend_rows = 2 + (options.agreement ? 1 : 0) + path_legend_rows(options.paths, heights);
  const Area area{kMargin + left_axis_width(up_ticks), kMargin + kNote, layout.width, layout.height};
  Picture picture(static_cast<std::size_t>(area.right() + kMargin),
                  static_cast<std::size_t>(area.bottom() + kBottomAxis + legend_rows * kFooterRow + kMargin / 2),
                  kPaper);
  picture.fill(area.x, area.y, area.width, area.height, options.colours.unknown);
  draw_columns(picture, map, options, columns, layout, area);
  draw_frame(picture, area, kBorder, kInk);
  draw_label(picture, area.x, kMargin, note_of(map, options, axes), kTextScale, kInk);

  if (columns.across == 0) {
    draw_label(picture, area.x, area.bottom() + kGap, "nothing is known", kTextScale, kInk);
    return picture;
  }
  const bool is_east_north = options.axes == MapAxes::kEastNorth;
  const std::array<std::string_view, 3> titles = {is_east_north ? "x in m, east" : "x in m",
                                                  is_east_north ? "y in m, north" : "y in m", "z in m"};
  draw_bottom_axis(picture, area, across_ticks, titles[axes.across]);
  draw_left_axis(picture, area, up_ticks, titles[axes.up]);

  const std::ptrdiff_t footer = area.bottom() + kBottomAxis;
  draw_scale_bar(picture, area.x, footer, {layout.metres_per_pixel, 200.0}, "");
  std::ptrdiff_t row = footer + kFooterRow;
  draw_legend(picture, area.x, row, map.options(), options);
  if (options.agreement) draw_agreement_legend(picture, area.x, row += kFooterRow, options.colours);
  draw_path_legend(picture, area.x, row + kFooterRow, options.paths, heights);
  draw_paths(picture, options.paths, heights, area, [&](const Eigen::Vector3d& at) {
    const double across_share = layout.across.share_of(at[static_cast<Eigen::Index>(axes.across)]);
    const double up_share = layout.up.share_of(at[static_cast<Eigen::Index>(axes.up)]);
    return Spot{static_cast<double>(area.x) + across_share * static_cast<double>(area.width),
                static_cast<double>(area.bottom()) - up_share * static_cast<double>(area.height)};
  });
  if (is_east_north && options.view == MapView::kAbove) draw_north(picture, area);
  const double origin_across = layout.across.share_of(0.0), origin_up = layout.up.share_of(0.0);
  const auto is_inside = [](double share) { return share >= 0.0 && share < 1.0; };
  if (is_inside(origin_across) && is_inside(origin_up)) {
    draw_cross(picture, area.x + std::lround(origin_across * static_cast<double>(area.width)),
               area.bottom() - std::lround(origin_up * static_cast<double>(area.height)));
    const std::ptrdiff_t x = area.right() - label_width("origin", kTextScale);
    draw_label(picture, x, footer + 2, "origin", kTextScale, kInk);
    draw_cross(picture, x - 20, footer + 9);
  }
  return picture;
}

}  // namespace pingvox
