#include "pingvox/viewer/render_map.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "base/option_errors.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/label.hpp"
#include "viewer/map_paths.hpp"
#include "viewer/strokes.hpp"

namespace pingvox {
namespace {

constexpr float kNoCell = -std::numeric_limits<float>::infinity();

constexpr std::ptrdiff_t kNote = 26, kBorder = 2;
constexpr std::ptrdiff_t kMinMapWidth = 480;  ///< room for scale bar and legend
constexpr Rgb kCross{230, 120, 0};

/// Axes of the map frame (0 x, 1 y, 2 z) that are horizontal and vertical in the picture; vertical always grows
/// upwards.
struct ViewAxes {
  std::size_t across, up;
  enum class Across { kGrowsRightwards, kGrowsLeftwards } grows;
  std::string_view note;
};

ViewAxes view_axes(const MapPictureOptions& options) {
  using enum ViewAxes::Across;
  const bool has_north = options.axes == MapAxes::kEastNorth;
  switch (options.view) {
    case MapView::kRight:
      return {0, 2, kGrowsRightwards, has_north ? "from the south" : "from the right"};
    case MapView::kLeft:
      return {0, 2, kGrowsLeftwards, has_north ? "from the north" : "from the left"};
    case MapView::kFront:
      return {1, 2, kGrowsRightwards, has_north ? "from the east" : "from the front"};
    case MapView::kBehind:
      return {1, 2, kGrowsLeftwards, has_north ? "from the west" : "from behind"};
    case MapView::kAbove:
      break;
  }
  if (has_north) return {0, 1, kGrowsRightwards, "from above, north up"};
  if (options.axes == MapAxes::kRightAhead) return {0, 1, kGrowsRightwards, "from above"};
  return {1, 0, kGrowsLeftwards, "from above"};
}

WideWord word_along(const WideKey& key, std::size_t axis) {
  return axis == 0 ? key.x : (axis == 1 ? key.y : key.z);
}

/// Maximum log-odds of each column of cells along the view. (0, 0) is the lowest cell; kNoCell is unknown.
struct Columns {
  std::size_t across = 0, up = 0;  ///< how many
  double cell_m = 0.0;
  double least_across_m = 0.0, least_up_m = 0.0;
  WideWord first_across = 0, first_up = 0;  ///< key components of the lowest column, shifted
  int shift = 0;                            ///< levels that a column is larger than a cell
  std::vector<float> belief;

  float at(std::size_t a, std::size_t u) const { return belief[u * across + a]; }
};

/// One level of a pyramid of grids, each cell covering four of the next finer one. A leaf is entered in the grid of its
/// own size, so large leaves cost no more than small ones.
struct Grid {
  WideWord least_across, least_up;  ///< key components of the lowest cell
  std::size_t across, up;
  std::vector<float> belief;

  void raise(WideWord a, WideWord u, float value) {
    float& cell = belief[static_cast<std::size_t>(u - least_up) * across + static_cast<std::size_t>(a - least_across)];
    cell = std::max(cell, value);
  }
};

/// `word >> bits`, 0 for a shift by the width of the word (undefined in C++), which happens at the root of 128 levels.
WideWord shift_right(WideWord word, int bits) {
  return bits < kMaxDepth ? word >> bits : 0;
}

/// Lower and upper height of the layer of cells at `z_m`; nullopt outside of the lattice.
std::optional<std::pair<double, double>> layer_at(const Lattice& lattice, double z_m) {
  // A hair below a face is rounding.
  const auto key = lattice.key_of<WideWord>({0.0, 0.0, z_m + 1e-6 * lattice.resolution_m()});
  if (!key) return std::nullopt;
  const double low_m = lattice.lowest_corner_of(*key, lattice.depth()).z();
  return std::pair(low_m, low_m + lattice.resolution_m());
}

template <class Visitor>
void for_each_shown(const OccupancyMap& map, const MapPictureOptions& options, Visitor visit) {
  LeafQuery query;
  const double inf = std::numeric_limits<double>::infinity();
  if (options.layer_z_m) {
    const auto layer = layer_at(map.lattice(), *options.layer_z_m);
    if (!layer) return;
    // The middle of the layer, safe from rounding.
    const double middle_m = layer->first + 0.5 * (layer->second - layer->first);
    query.box = Box{{-inf, -inf, middle_m}, {inf, inf, middle_m}};
  } else if (options.min_z_m || options.max_z_m) {
    query.box = Box{{-inf, -inf, options.min_z_m.value_or(-inf)}, {inf, inf, options.max_z_m.value_or(inf)}};
  }
  for_each_leaf(map, query, visit);
}

/// Lowest and highest cell of the shown part.
struct Corners {
  WideKey low, high;
};

std::optional<Corners> corners_of(const OccupancyMap& map, const MapPictureOptions& options) {
  const int levels = map.lattice().depth();
  WideKey low{~WideWord{0}, ~WideWord{0}, ~WideWord{0}}, high{0, 0, 0};
  for_each_shown(map, options, [&](const Leaf& leaf) {
    const int bits = levels - leaf.depth;
    const WideWord last = bits == 0 ? 0 : (~WideWord{0} >> (kMaxDepth - bits));
    low = {std::min(low.x, leaf.key.x), std::min(low.y, leaf.key.y), std::min(low.z, leaf.key.z)};
    high = {std::max(high.x, leaf.key.x + last), std::max(high.y, leaf.key.y + last),
            std::max(high.z, leaf.key.z + last)};
  });
  if (low.x > high.x) return std::nullopt;
  return Corners{low, high};
}

/// Expands corners to include a box, within the lattice.
Corners expand(const Corners& corners, const Box& box, const Lattice& lattice) {
  Corners wide = corners;
  const auto low = lattice.key_of<WideWord>(box.min);
  // The upper face belongs to the cells beyond it.
  const auto high = lattice.key_of<WideWord>(box.max.array() - 0.5 * lattice.resolution_m());
  if (low) wide.low = {std::min(wide.low.x, low->x), std::min(wide.low.y, low->y), std::min(wide.low.z, low->z)};
  if (high)
    wide.high = {std::max(wide.high.x, high->x), std::max(wide.high.y, high->y), std::max(wide.high.z, high->z)};
  return wide;
}

/// The shown part: cells, paths, and the box that is to be shown at least.
std::optional<Corners> shown_corners(const OccupancyMap& map, const MapPictureOptions& options) {
  const std::optional<Corners> corners = corners_of(map, options);
  if (!corners) return std::nullopt;
  Eigen::AlignedBox3d ways;
  for (const MapPath& path : options.paths) {
    for (const StampedPose& pose : path.map_from_body.poses()) ways.extend(pose.map_from_body.translation());
  }
  if (ways.isEmpty()) return corners;
  // With the cell of the upper corner.
  return expand(*corners, {ways.min(), ways.max().array() + 0.5 * map.lattice().resolution_m()}, map.lattice());
}

/// Columns of the shown part, at most `most` along each side.
Columns columns_of(const OccupancyMap& map, const MapPictureOptions& options, std::size_t most) {
  const ViewAxes axes = view_axes(options);
  const Lattice& lattice = map.lattice();
  const int levels = lattice.depth();
  const std::optional<Corners> known = shown_corners(map, options);
  if (!known) return {};
  const auto [low, high] = options.at_least ? expand(*known, *options.at_least, lattice) : *known;

  const WideWord low_across = word_along(low, axes.across), low_up = word_along(low, axes.up);
  const WideWord high_across = word_along(high, axes.across), high_up = word_along(high, axes.up);
  int shift = 0;
  const auto cells = [&](WideWord from, WideWord to) { return shift_right(to, shift) - shift_right(from, shift); };
  while (cells(low_across, high_across) >= most || cells(low_up, high_up) >= most) ++shift;

  std::vector<Grid> grids;
  for (int bits = shift; bits <= levels; ++bits) {
    const WideWord least_across = shift_right(low_across, bits), least_up = shift_right(low_up, bits);
    const auto across = static_cast<std::size_t>(shift_right(high_across, bits) - least_across) + 1;
    const auto up = static_cast<std::size_t>(shift_right(high_up, bits) - least_up) + 1;
    grids.push_back({least_across, least_up, across, up, std::vector<float>(across * up, kNoCell)});
  }
  for_each_shown(map, options, [&](const Leaf& leaf) {
    const int bits = std::max(levels - leaf.depth, shift);
    grids[static_cast<std::size_t>(bits - shift)].raise(shift_right(word_along(leaf.key, axes.across), bits),
                                                        shift_right(word_along(leaf.key, axes.up), bits),
                                                        leaf.belief.value());
  });
  for (std::size_t g = grids.size() - 1; g > 0; --g) {
    const Grid& coarse = grids[g];
    Grid& fine = grids[g - 1];
    for (std::size_t u = 0; u < fine.up; ++u) {
      for (std::size_t a = 0; a < fine.across; ++a) {
        const auto coarse_a = static_cast<std::size_t>(((fine.least_across + a) >> 1) - coarse.least_across);
        const auto coarse_u = static_cast<std::size_t>(((fine.least_up + u) >> 1) - coarse.least_up);
        float& cell = fine.belief[u * fine.across + a];
        cell = std::max(cell, coarse.belief[coarse_u * coarse.across + coarse_a]);
      }
    }
  }

  const int depth = levels - std::min(shift, levels);
  const Eigen::Vector3d corner_m = lattice.lowest_corner_of(low, depth);
  return {grids[0].across,
          grids[0].up,
          lattice.cell_size_m(depth),
          corner_m[static_cast<Eigen::Index>(axes.across)],
          corner_m[static_cast<Eigen::Index>(axes.up)],
          grids[0].least_across,
          grids[0].least_up,
          shift,
          std::move(grids[0].belief)};
}

/// How echoes agree with the occupied cells of a column.
struct ColumnAgreement {
  std::size_t judged = 0, agreed = 0;
};

/// Of each column of a picture.
std::vector<ColumnAgreement> agreement_of(const OccupancyMap& map, const MapPictureOptions& options,
                                          const ViewAxes& axes, const Columns& columns) {
  std::vector<ColumnAgreement> all(columns.belief.size());
  const auto layer = options.layer_z_m ? layer_at(map.lattice(), *options.layer_z_m) : std::nullopt;
  const double low_m = layer ? layer->first : options.min_z_m.value_or(-std::numeric_limits<double>::infinity());
  const double high_m = layer ? layer->second : options.max_z_m.value_or(std::numeric_limits<double>::infinity());
  for (const CellAgreement& cell : *options.agreement) {
    if (map.classify(cell.cell) != Occupancy::kOccupied) continue;
    const double z_m = map.lattice().centre_of(cell.cell).z();
    if (z_m < low_m || z_m > high_m) continue;
    const WideWord across = shift_right(word_along(cell.cell, axes.across), columns.shift) - columns.first_across;
    const WideWord up = shift_right(word_along(cell.cell, axes.up), columns.shift) - columns.first_up;
    if (across >= columns.across || up >= columns.up) continue;
    ColumnAgreement& column = all[static_cast<std::size_t>(up) * columns.across + static_cast<std::size_t>(across)];
    column.judged += cell.judged;
    column.agreed += cell.agreed;
  }
  return all;
}

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

std::optional<Box> shown_part(const OccupancyMap& map, const MapPictureOptions& options) {
  assert(options.validate());
  const std::optional<Corners> corners = shown_corners(map, options);
  if (!corners) return std::nullopt;
  const Lattice& lattice = map.lattice();
  const Eigen::Vector3d low_m = lattice.lowest_corner_of(corners->low, lattice.depth());
  const Eigen::Vector3d high_m = lattice.lowest_corner_of(corners->high, lattice.depth());
  return Box{low_m, high_m.array() + lattice.resolution_m()};
}

Picture render_map(const OccupancyMap& map, const MapPictureOptions& options) {
  assert(options.validate());
  const ViewAxes axes = view_axes(options);
  const Columns columns = columns_of(map, options, options.target_px);
  const std::size_t longer = std::max({columns.across, columns.up, std::size_t{1}});
  // Up to 15% larger than requested rather than half as large; a single cell need not fill the picture.
  const auto zoom = static_cast<std::ptrdiff_t>(std::clamp<std::size_t>(options.target_px * 23 / 20 / longer, 1, 64));
  const auto across = static_cast<std::ptrdiff_t>(columns.across), up = static_cast<std::ptrdiff_t>(columns.up);
  // A margin of unknown around the known part shows its outline.
  const std::ptrdiff_t halo = std::max<std::ptrdiff_t>(zoom, 8);
  const std::ptrdiff_t width = std::max(across * zoom + 2 * halo, kMinMapWidth), height = up * zoom + 2 * halo;

  // Relative to the corner of the area, in pixels.
  const std::ptrdiff_t known_left = (width - across * zoom) / 2;
  const bool is_mirrored = axes.grows == ViewAxes::Across::kGrowsLeftwards;
  const double metres_per_pixel = columns.cell_m / static_cast<double>(zoom);
  const auto metres = [&](std::ptrdiff_t pixels) { return static_cast<double>(pixels) * metres_per_pixel; };
  const std::ptrdiff_t known_right = width - known_left - across * zoom;
  const double before_m = columns.least_across_m - metres(is_mirrored ? known_right : known_left);
  const double behind_m = before_m + metres(width);
  const AxisScale across_scale = is_mirrored ? AxisScale{behind_m, before_m} : AxisScale{before_m, behind_m};
  const double bottom_m = columns.least_up_m - metres(halo);
  const AxisScale up_scale{bottom_m, bottom_m + metres(height)};
  const auto ticks_on = [](std::ptrdiff_t pixels) {
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(pixels / 80, 4, 12));
  };
  const std::vector<Tick> across_ticks = ticks_of(across_scale, ticks_on(width));
  const std::vector<Tick> up_ticks = ticks_of(up_scale, ticks_on(height));

  const std::optional<PathHeights> heights = heights_shown(options, map.lattice().resolution_m());
  const std::ptrdiff_t legend_rows = 2 + (options.agreement ? 1 : 0) + path_legend_rows(options.paths, heights);
  const Area area{kMargin + left_axis_width(up_ticks), kMargin + kNote, width, height};
  Picture picture(static_cast<std::size_t>(area.right() + kMargin),
                  static_cast<std::size_t>(area.bottom() + kBottomAxis + legend_rows * kFooterRow + kMargin / 2),
                  kPaper);
  picture.fill(area.x, area.y, area.width, area.height, options.colours.unknown);
  const std::vector<ColumnAgreement> agreement =
      options.agreement ? agreement_of(map, options, axes, columns) : std::vector<ColumnAgreement>();
  for (std::ptrdiff_t a = 0; a < across; ++a) {
    const std::ptrdiff_t x = area.x + known_left + (is_mirrored ? across - 1 - a : a) * zoom;
    for (std::ptrdiff_t u = 0; u < up; ++u) {
      const auto column_a = static_cast<std::size_t>(a), column_u = static_cast<std::size_t>(u);
      const float belief = columns.at(column_a, column_u);
      const bool shows_agreement = options.agreement && belief != kNoCell &&
                                   classify(LogOdds(belief), map.options().thresholds) == Occupancy::kOccupied;
      const Rgb colour = shows_agreement ? colour_of(agreement[column_u * columns.across + column_a], options.colours)
                                         : colour_of(belief, map.options(), options.colours);
      picture.fill(x, area.y + halo + (up - 1 - u) * zoom, zoom, zoom, colour);
    }
  }
  draw_frame(picture, area, kBorder, kInk);
  draw_label(picture, area.x, kMargin, note_of(map, options, axes), kTextScale, kInk);

  if (across == 0) {
    draw_label(picture, area.x, area.bottom() + kGap, "nothing is known", kTextScale, kInk);
    return picture;
  }
  const bool is_east_north = options.axes == MapAxes::kEastNorth;
  const std::array<std::string_view, 3> titles = {is_east_north ? "x in m, east" : "x in m",
                                                  is_east_north ? "y in m, north" : "y in m", "z in m"};
  draw_bottom_axis(picture, area, across_ticks, titles[axes.across]);
  draw_left_axis(picture, area, up_ticks, titles[axes.up]);

  const std::ptrdiff_t footer = area.bottom() + kBottomAxis;
  draw_scale_bar(picture, area.x, footer, {metres_per_pixel, 200.0}, "");
  std::ptrdiff_t row = footer + kFooterRow;
  draw_legend(picture, area.x, row, map.options(), options);
  if (options.agreement) draw_agreement_legend(picture, area.x, row += kFooterRow, options.colours);
  draw_path_legend(picture, area.x, row + kFooterRow, options.paths, heights);
  draw_paths(picture, options.paths, heights, area, [&](const Eigen::Vector3d& at) {
    const double across_share = across_scale.share_of(at[static_cast<Eigen::Index>(axes.across)]);
    const double up_share = up_scale.share_of(at[static_cast<Eigen::Index>(axes.up)]);
    return Spot{static_cast<double>(area.x) + across_share * static_cast<double>(width),
                static_cast<double>(area.bottom()) - up_share * static_cast<double>(height)};
  });
  if (is_east_north && options.view == MapView::kAbove) draw_north(picture, area);
  const double origin_across = across_scale.share_of(0.0), origin_up = up_scale.share_of(0.0);
  const auto is_inside = [](double share) { return share >= 0.0 && share < 1.0; };
  if (is_inside(origin_across) && is_inside(origin_up)) {
    draw_cross(picture, area.x + std::lround(origin_across * static_cast<double>(width)),
               area.bottom() - std::lround(origin_up * static_cast<double>(height)));
    const std::ptrdiff_t x = area.right() - label_width("origin", kTextScale);
    draw_label(picture, x, footer + 2, "origin", kTextScale, kInk);
    draw_cross(picture, x - 20, footer + 9);
  }
  return picture;
}

}  // namespace pingvox
