#include "viewer/map_columns.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>

#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

WideWord word_along(const WideKey& key, std::size_t axis) {
  return axis == 0 ? key.x : (axis == 1 ? key.y : key.z);
}

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

/// The shown part: cells and paths.
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

}  // namespace

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

std::optional<std::pair<double, double>> layer_at(const Lattice& lattice, double z_m) {
  // A hair below a face is rounding.
  const auto key = lattice.key_of<WideWord>({0.0, 0.0, z_m + 1e-6 * lattice.resolution_m()});
  if (!key) return std::nullopt;
  const double low_m = lattice.lowest_corner_of(*key, lattice.depth()).z();
  return std::pair(low_m, low_m + lattice.resolution_m());
}

MapColumns columns_of(const OccupancyMap& map, const MapPictureOptions& options, std::size_t most) {
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

std::vector<ColumnAgreement> agreement_of(const OccupancyMap& map, const MapPictureOptions& options,
                                          const ViewAxes& axes, const MapColumns& columns) {
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

std::optional<Box> shown_part(const OccupancyMap& map, const MapPictureOptions& options) {
  assert(options.validate());
  const std::optional<Corners> corners = shown_corners(map, options);
  if (!corners) return std::nullopt;
  const Lattice& lattice = map.lattice();
  const Eigen::Vector3d low_m = lattice.lowest_corner_of(corners->low, lattice.depth());
  const Eigen::Vector3d high_m = lattice.lowest_corner_of(corners->high, lattice.depth());
  return Box{low_m, high_m.array() + lattice.resolution_m()};
}

}  // namespace pingvox
