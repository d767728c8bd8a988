#include "pingvox/analysis/slice.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

/// Cells of the finest resolution by their words; all six belong to the range.
struct KeyBox {
  WideKey first, last;
};

/// The cells of a leaf.
KeyBox cells_of(const Leaf& leaf, int levels) {
  const int bits = levels - leaf.depth;
  const WideWord rest = bits == 0 ? 0 : ~WideWord{0} >> (kMaxDepth - bits);
  const WideKey& low = leaf.key;
  return {low, {low.x + rest, low.y + rest, low.z + rest}};
}

/// The layer that holds a height; the lowest or highest one for what lies outside of the lattice.
WideWord layer_of(const Lattice& lattice, double z_m) {
  if (const auto key = lattice.key_of<WideWord>({0.0, 0.0, z_m})) return key->z;
  return z_m < 0.0 ? 0 : ~WideWord{0} >> (kMaxDepth - lattice.depth());
}

/// The first and the last layer of a slice.
std::pair<WideWord, WideWord> layers_of(const Lattice& lattice, const SliceOptions& options) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  // A range that ends with a face does not reach into the layer above it, nor one that begins with a face into the
  // layer below. A hair of one is rounding.
  const double hair_m = 1e-6 * lattice.resolution_m();
  const WideWord first = layer_of(lattice, options.min_z_m.value_or(-kInf) + hair_m);
  const WideWord last = layer_of(lattice, options.max_z_m.value_or(kInf) - hair_m);
  return {first, std::max(first, last)};
}

/// Calls `visit(leaf, cells)` for each leaf that has cells in the slice, with those cells.
template <class Visitor>
void for_each_in_slice(const OccupancyMap& map, const SliceOptions& options, Visitor visit) {
  const auto [first, last] = layers_of(map.lattice(), options);
  for_each_leaf(map, [&, low = first, high = last](const Leaf& leaf) {
    KeyBox cells = cells_of(leaf, map.lattice().depth());
    if (cells.first.z > high || cells.last.z < low) return;
    cells.first.z = std::max(cells.first.z, low);
    cells.last.z = std::min(cells.last.z, high);
    visit(leaf, cells);
  });
}

std::string heights_text(const SliceOptions& options) {
  if (!options.min_z_m && !options.max_z_m) return "";
  if (options.min_z_m == options.max_z_m) return fmt::format(" at a height of {:g} m", *options.min_z_m);
  const auto shown = [](const std::optional<double>& z) { return z ? fmt::format("{:g}", *z) : std::string(); };
  return fmt::format(" at heights {}..{} m", shown(options.min_z_m), shown(options.max_z_m));
}

/// The columns of a slice that is not empty.
struct Frame {
  KeyBox box;
  std::size_t columns = 0, rows = 0;
};

/// What is known of a slice.
Result<KeyBox> known_box(const OccupancyMap& map, const SliceOptions& options) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  const WideWord none = ~WideWord{0};
  KeyBox box{{none, none, none}, {0, 0, 0}};
  for_each_in_slice(map, options, [&](const Leaf&, const KeyBox& cells) {
    box.first = {std::min(box.first.x, cells.first.x), std::min(box.first.y, cells.first.y),
                 std::min(box.first.z, cells.first.z)};
    box.last = {std::max(box.last.x, cells.last.x), std::max(box.last.y, cells.last.y),
                std::max(box.last.z, cells.last.z)};
  });
  if (box.first.x > box.last.x) {
    return fail(Error::Code::kUnsupported, fmt::format("nothing is known{}", heights_text(options)));
  }
  return box;
}

Result<Frame> frame_of(const OccupancyMap& map, const SliceOptions& options, std::size_t most) {
  const Result<KeyBox> known = known_box(map, options);
  if (!known) return tl::unexpected(known.error());
  const KeyBox& box = *known;
  const double columns = static_cast<double>(box.last.x - box.first.x) + 1.0;
  const double rows = static_cast<double>(box.last.y - box.first.y) + 1.0;
  if (columns * rows > static_cast<double>(most)) {
    return fail(Error::Code::kLimit,
                fmt::format("a grid of {:.0f} x {:.0f} cells exceeds the limit of {}", columns, rows, most));
  }
  return Frame{box, static_cast<std::size_t>(columns), static_cast<std::size_t>(rows)};
}

template <class T>
Raster<T> raster_of(const Lattice& lattice, const Frame& frame, T value) {
  const Eigen::Vector3d corner_m = lattice.lowest_corner_of(frame.box.first, lattice.depth());
  return {frame.columns, frame.rows, lattice.resolution_m(), corner_m.head<2>(),
          std::vector<T>(frame.columns * frame.rows, value)};
}

/// Calls `take(value)` for the columns above and below some cells.
template <class T, class Take>
void for_each_column(Raster<T>& raster, const Frame& frame, const KeyBox& cells, Take take) {
  const auto from = [](WideWord word, WideWord first) { return static_cast<std::size_t>(word - first); };
  const std::size_t first = from(cells.first.x, frame.box.first.x), last = from(cells.last.x, frame.box.first.x);
  for (std::size_t row = from(cells.first.y, frame.box.first.y); row <= from(cells.last.y, frame.box.first.y); ++row) {
    for (std::size_t column = first; column <= last; ++column) take(raster.values[row * raster.columns + column]);
  }
}

/// Sets the cells of a node that lie in the layers `first` to `last`, as few nodes as possible.
void set_layers(Editor& editor, const Leaf& node, WideWord first, WideWord last, int levels) {
  const KeyBox cells = cells_of(node, levels);
  if (cells.first.z > last || cells.last.z < first) return;
  if (cells.first.z >= first && cells.last.z <= last) {
    editor.set(node.key, node.depth, node.belief);
    return;
  }
  const WideWord half = WideWord{1} << (levels - node.depth - 1);
  for (int octant = 0; octant < 8; ++octant) {
    const auto child = [&](WideWord word, int axis) { return word + ((octant >> axis & 1) != 0 ? half : 0); };
    const WideKey key{child(node.key.x, 0), child(node.key.y, 1), child(node.key.z, 2)};
    set_layers(editor, {key, node.depth + 1, node.belief, node.lattice}, first, last, levels);
  }
}

}  // namespace

Result<void> SliceOptions::validate() const {
  for (const auto& z : {min_z_m, max_z_m}) {
    if (z && !std::isfinite(*z)) return fail(Error::Code::kBadOption, "the heights of a slice must be finite");
  }
  if (min_z_m && max_z_m && *min_z_m > *max_z_m) {
    return fail(
        Error::Code::kBadOption,
        fmt::format("the lower end of a slice ({:g} m) must not be above the upper one ({:g} m)", *min_z_m, *max_z_m));
  }
  return {};
}

Result<Raster<Occupancy>> slice_of(const OccupancyMap& map, const SliceOptions& options) {
  const Result<Frame> frame = frame_of(map, options, kMaxRasterCells);
  if (!frame) return tl::unexpected(frame.error());
  auto raster = raster_of(map.lattice(), *frame, Occupancy::kUnknown);
  for_each_in_slice(map, options, [&](const Leaf& leaf, const KeyBox& cells) {
    // Unknown, free, occupied: each one beats those before it.
    const Occupancy occupancy = classify(leaf.belief, map.options().thresholds);
    for_each_column(raster, *frame, cells, [occupancy](Occupancy& value) { value = std::max(value, occupancy); });
  });
  return raster;
}

Result<void> check_slice(const OccupancyMap& map, const SliceOptions& options) {
  return known_box(map, options).map([](const KeyBox&) {});
}

Result<OccupancyMap> map_of_slice(const OccupancyMap& map, const SliceOptions& options) {
  if (const auto known = check_slice(map, options); !known) return tl::unexpected(known.error());
  const int levels = map.lattice().depth();
  const auto [first, last] = layers_of(map.lattice(), options);
  double cut_columns = 0.0;
  for_each_leaf(map, [&, low = first, high = last](const Leaf& leaf) {
    const KeyBox cells = cells_of(leaf, levels);
    const bool is_cut = cells.first.z <= high && cells.last.z >= low && (cells.first.z < low || cells.last.z > high);
    if (is_cut) cut_columns += std::pow(static_cast<double>(cells.last.x - cells.first.x) + 1.0, 2);
  });
  if (cut_columns > static_cast<double>(kMaxRasterCells)) {
    return fail(Error::Code::kLimit, fmt::format("leaves that are cut{} have {:.0f} columns of cells, more than {}",
                                                 heights_text(options), cut_columns, kMaxRasterCells));
  }
  OccupancyMap out(map.options());
  Editor editor = out.edit();
  for_each_leaf(map, [&, low = first, high = last](const Leaf& leaf) { set_layers(editor, leaf, low, high, levels); });
  editor.synchronize();
  return out;
}

Result<Raster<float>> heights_of(const OccupancyMap& map, const SliceOptions& options, Surface surface) {
  const Result<Frame> frame = frame_of(map, options, kMaxRasterCells / 4);
  if (!frame) return tl::unexpected(frame.error());
  const Lattice& lattice = map.lattice();
  auto raster = raster_of(lattice, *frame, std::numeric_limits<float>::quiet_NaN());
  bool is_empty = true;
  for_each_in_slice(map, options, [&](const Leaf& leaf, const KeyBox& cells) {
    if (classify(leaf.belief, map.options().thresholds) != Occupancy::kOccupied) return;
    is_empty = false;
    const WideKey cell{cells.first.x, cells.first.y, surface == Surface::kHighest ? cells.last.z : cells.first.z};
    const auto top_m = static_cast<float>(lattice.centre_of(cell).z() + 0.5 * lattice.resolution_m());
    for_each_column(raster, *frame, cells, [&](float& value) {
      // fmax and fmin take the number where the other is NaN.
      value = surface == Surface::kHighest ? std::fmax(value, top_m) : std::fmin(value, top_m);
    });
  });
  if (is_empty) return fail(Error::Code::kUnsupported, fmt::format("nothing is occupied{}", heights_text(options)));
  return raster;
}

}  // namespace pingvox
