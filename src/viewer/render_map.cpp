#include "pingvox/viewer/render_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "pingvox/map/for_each_leaf.hpp"
#include "viewer/axis.hpp"
#include "viewer/colours.hpp"
#include "viewer/label.hpp"
#include "viewer/strokes.hpp"

namespace pingvox {
namespace {

constexpr float kNothing = -std::numeric_limits<float>::infinity();

constexpr std::ptrdiff_t kMargin = 24, kFooter = 56, kBorder = 2;
constexpr std::ptrdiff_t kLeastWidth = 640;  ///< room for scale bar and legend
constexpr Rgb kCross{230, 120, 0};

/// The highest belief of each column of cells. Cells are square, (0, 0) has the lowest x and y; kNothing is unknown.
struct Columns {
  std::size_t nx = 0, ny = 0;
  double cell_m = 0.0;
  double min_x_m = 0.0, min_y_m = 0.0;
  std::vector<float> belief;

  float at(std::size_t x, std::size_t y) const { return belief[y * nx + x]; }
};

/// Cells of one size: those of the next finer grid in fours. A leaf is one entry of the grid of its own size, so a leaf
/// that covers the whole picture costs as little as a small one.
struct Grid {
  WideWord min_x, min_y;  ///< words of the lowest cell
  std::size_t nx, ny;
  std::vector<float> belief;

  void raise(WideWord x, WideWord y, float value) {
    float& cell = belief[static_cast<std::size_t>(y - min_y) * nx + static_cast<std::size_t>(x - min_x)];
    cell = std::max(cell, value);
  }
};

/// Words shifted by as many bits as a word has would be undefined: at 128 levels the root is such a cell.
WideWord shifted(WideWord word, int bits) {
  return bits < kMaxDepth ? word >> bits : 0;
}

template <class Visitor>
void for_each_shown(const OccupancyMap& map, const MapPictureOptions& options, Visitor visit) {
  LeafQuery query;
  if (options.min_z_m || options.max_z_m) {
    const double inf = std::numeric_limits<double>::infinity();
    query.box = Box{{-inf, -inf, options.min_z_m.value_or(-inf)}, {inf, inf, options.max_z_m.value_or(inf)}};
  }
  for_each_leaf<WideWord>(map, query, visit);
}

/// Columns of the shown part, at most `most` of them along each side.
Columns columns_of(const OccupancyMap& map, const MapPictureOptions& options, std::size_t most) {
  const Lattice& lattice = map.lattice();
  const int levels = lattice.depth();
  WideKey low{~WideWord{0}, ~WideWord{0}, 0}, high{0, 0, 0};
  for_each_shown(map, options, [&](const Leaf<WideWord>& leaf) {
    const int bits = levels - leaf.depth;
    const WideWord last = bits == 0 ? 0 : (~WideWord{0} >> (kMaxDepth - bits));
    low.x = std::min(low.x, leaf.key.x);
    low.y = std::min(low.y, leaf.key.y);
    high.x = std::max(high.x, leaf.key.x + last);
    high.y = std::max(high.y, leaf.key.y + last);
  });
  if (low.x > high.x) return {};

  int shift = 0;
  const auto cells = [&](WideWord from, WideWord to) { return shifted(to, shift) - shifted(from, shift); };
  while (cells(low.x, high.x) >= most || cells(low.y, high.y) >= most) ++shift;

  std::vector<Grid> grids;
  for (int bits = shift; bits <= levels; ++bits) {
    const WideWord min_x = shifted(low.x, bits), min_y = shifted(low.y, bits);
    const auto nx = static_cast<std::size_t>(shifted(high.x, bits) - min_x) + 1;
    const auto ny = static_cast<std::size_t>(shifted(high.y, bits) - min_y) + 1;
    grids.push_back({min_x, min_y, nx, ny, std::vector<float>(nx * ny, kNothing)});
  }
  for_each_shown(map, options, [&](const Leaf<WideWord>& leaf) {
    const int bits = std::max(levels - leaf.depth, shift);
    grids[static_cast<std::size_t>(bits - shift)].raise(shifted(leaf.key.x, bits), shifted(leaf.key.y, bits),
                                                        leaf.belief.value());
  });
  for (std::size_t g = grids.size() - 1; g > 0; --g) {
    const Grid& coarse = grids[g];
    Grid& fine = grids[g - 1];
    for (std::size_t y = 0; y < fine.ny; ++y) {
      for (std::size_t x = 0; x < fine.nx; ++x) {
        const auto above_x = static_cast<std::size_t>(((fine.min_x + x) >> 1) - coarse.min_x);
        const auto above_y = static_cast<std::size_t>(((fine.min_y + y) >> 1) - coarse.min_y);
        float& cell = fine.belief[y * fine.nx + x];
        cell = std::max(cell, coarse.belief[above_y * coarse.nx + above_x]);
      }
    }
  }

  const Eigen::Vector3d corner_m = lattice.lowest_corner_of(low, levels - std::min(shift, levels));
  return {grids[0].nx,  grids[0].ny,  lattice.cell_size_m(levels - std::min(shift, levels)),
          corner_m.x(), corner_m.y(), std::move(grids[0].belief)};
}

/// How far `belief` has come from `from` (0) to `to` (1).
double share_of(LogOdds belief, LogOdds from, LogOdds to) {
  const double way = static_cast<double>(to.value()) - static_cast<double>(from.value());
  if (!(std::fabs(way) > 0.0)) return 1.0;
  return std::clamp((static_cast<double>(belief.value()) - static_cast<double>(from.value())) / way, 0.0, 1.0);
}

Rgb colour_of(float belief, const MapOptions& map, const MapColours& colours) {
  if (belief == kNothing) return colours.unknown;
  switch (classified(LogOdds(belief), map.thresholds)) {
    case Occupancy::kOccupied:
      return mixed(colours.barely_occupied, colours.surely_occupied,
                   share_of(LogOdds(belief), map.thresholds.upper, map.clamp.highest));
    case Occupancy::kFree:
      return mixed(colours.barely_free, colours.surely_free,
                   share_of(LogOdds(belief), map.thresholds.lower, map.clamp.lowest));
    case Occupancy::kUnknown:
      break;
  }
  return colours.undecided;
}

/// An orange cross with a dark edge, to be seen on light and dark cells alike.
void draw_cross(Picture& picture, std::ptrdiff_t x, std::ptrdiff_t y) {
  constexpr std::ptrdiff_t kArm = 11;
  picture.fill(x - kArm - 1, y - 2, 2 * kArm + 3, 5, kPaper);
  picture.fill(x - 2, y - kArm - 1, 5, 2 * kArm + 3, kPaper);
  picture.fill(x - kArm, y - 1, 2 * kArm + 1, 3, kCross);
  picture.fill(x - 1, y - kArm, 3, 2 * kArm + 1, kCross);
}

void draw_footer(Picture& picture, std::ptrdiff_t top, double metres_per_pixel, const MapColours& colours) {
  constexpr std::ptrdiff_t kSwatch = 18, kGap = 8;
  constexpr double kScaleBar = 130.0;  // at most, in pixels: the legend needs the rest of the narrowest picture
  const std::ptrdiff_t text_y = top + 1;

  // A lattice may be larger than doubles can say.
  if (std::isfinite(metres_per_pixel * kScaleBar)) {
    const double length_m = round_length(metres_per_pixel * kScaleBar);
    const auto bar = static_cast<std::ptrdiff_t>(std::lround(length_m / metres_per_pixel));
    picture.fill(kMargin, top + 8, bar, 3, kInk);
    picture.fill(kMargin, top + 2, 3, 15, kInk);
    picture.fill(kMargin + bar - 3, top + 2, 3, 15, kInk);
    draw_label(picture, kMargin + bar + kGap, text_y, length_text(length_m) + " m", kTextScale, kInk);
  }

  struct Entry {
    std::string_view text;
    Rgb colour;
  };
  const std::array legend = {Entry{"occupied", colours.surely_occupied}, Entry{"free", colours.surely_free},
                             Entry{"unknown", colours.unknown}};
  std::ptrdiff_t x = static_cast<std::ptrdiff_t>(picture.width()) - kMargin;
  for (auto entry = legend.rbegin(); entry != legend.rend(); ++entry) {
    x -= label_width(entry->text, kTextScale);
    draw_label(picture, x, text_y, entry->text, kTextScale, kInk);
    x -= kSwatch + kGap;
    picture.fill(x, top, kSwatch, kSwatch, entry->colour);
    draw_frame(picture, {x, top, kSwatch, kSwatch}, 1, kInk);
    x -= 3 * kGap;
  }
}

}  // namespace

Result<void> MapPictureOptions::validate() const {
  std::string bad;
  if (target_px < 16 || target_px > 3072) bad += fmt::format(" target_px must be in 16..3072, is {};", target_px);
  if ((min_z_m && std::isnan(*min_z_m)) || (max_z_m && std::isnan(*max_z_m)) ||
      (min_z_m && max_z_m && *min_z_m >= *max_z_m)) {
    bad += " min_z_m must be below max_z_m;";
  }
  if (bad.empty()) return {};
  bad.pop_back();
  return fail(Error::Code::kBadOption, "map picture:" + bad);
}

Picture render_map(const OccupancyMap& map, const MapPictureOptions& options) {
  assert(options.validate());
  const Columns columns = columns_of(map, options, options.target_px);
  const std::size_t longer = std::max({columns.nx, columns.ny, std::size_t{1}});
  // A single cell need not fill the picture.
  const auto zoom = static_cast<std::ptrdiff_t>(std::clamp<std::size_t>(options.target_px / longer, 1, 64));
  const auto nx = static_cast<std::ptrdiff_t>(columns.nx), ny = static_cast<std::ptrdiff_t>(columns.ny);
  // Something unknown is left around what is known, so that its outline shows.
  const std::ptrdiff_t halo = std::max<std::ptrdiff_t>(zoom, 8);
  const std::ptrdiff_t known_width = ny * zoom + 2 * halo, known_height = nx * zoom + 2 * halo;
  const std::ptrdiff_t inner_width = std::max(known_width, kLeastWidth - 2 * kMargin), inner_height = known_height;

  Picture picture(static_cast<std::size_t>(inner_width + 2 * kMargin),
                  static_cast<std::size_t>(inner_height + kMargin + kFooter), kPaper);
  picture.fill(kMargin, kMargin, inner_width, inner_height, options.colours.unknown);
  const std::ptrdiff_t left = kMargin + (inner_width - ny * zoom) / 2, top = kMargin + halo;
  for (std::ptrdiff_t x = 0; x < nx; ++x) {
    for (std::ptrdiff_t y = 0; y < ny; ++y) {
      const float belief = columns.at(static_cast<std::size_t>(x), static_cast<std::size_t>(y));
      picture.fill(left + (ny - 1 - y) * zoom, top + (nx - 1 - x) * zoom, zoom, zoom,
                   colour_of(belief, map.options(), options.colours));
    }
  }
  draw_frame(picture, {kMargin, kMargin, inner_width, inner_height}, kBorder, kInk);

  const std::ptrdiff_t footer = kMargin + inner_height + kMargin;
  if (nx == 0) {
    draw_label(picture, kMargin, footer, "nothing is known", kTextScale, kInk);
    return picture;
  }
  const double metres_per_pixel = columns.cell_m / static_cast<double>(zoom);
  const double origin_x = static_cast<double>(left + ny * zoom) + columns.min_y_m / metres_per_pixel;
  const double origin_y = static_cast<double>(top + nx * zoom) + columns.min_x_m / metres_per_pixel;
  const auto inside = [](double at, std::ptrdiff_t from, std::ptrdiff_t length) {
    return at >= static_cast<double>(from) && at < static_cast<double>(from + length);
  };
  if (inside(origin_x, kMargin, inner_width) && inside(origin_y, kMargin, inner_height)) {
    draw_cross(picture, std::lround(origin_x), std::lround(origin_y));
  }
  draw_footer(picture, footer, metres_per_pixel, options.colours);
  return picture;
}

}  // namespace pingvox
