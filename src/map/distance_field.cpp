#include "pingvox/map/distance_field.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "base/option_errors.hpp"
#include "base/without_exceptions.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

constexpr auto kTile = DistanceField::kTile;
constexpr std::size_t kTileCells = kTile * kTile;
constexpr std::size_t kMaxTiles = std::size_t{1} << 14;
constexpr double kMaxBoxTiles = 1 << 22;

enum : std::uint8_t { kNoCell = 0, kFreeCell = 1, kOccupiedCell = 2 };

/// Columns from `first` up to, not including, `end` on both axes.
struct Square {
  std::int64_t first_x, first_y, size;
};

/// Calls `visit(Square, is_occupied)` for each leaf of the layer that is free or occupied.
template <class Visit>
void for_each_square(const OccupancyMap& map, const DistanceFieldOptions& options, const Visit& visit) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const LeafQuery layer{std::nullopt, Box{{-kAny, -kAny, options.min_z_m}, {kAny, kAny, options.max_z_m}}};
  for_each_leaf(map, layer, [&](const Leaf& leaf) {
    const Occupancy what = classify(leaf.belief, map.options().thresholds);
    if (what == Occupancy::kUnknown) return;
    const Eigen::Vector3d corner = map.lattice().in_cells(leaf.centre_m().array() - 0.5 * leaf.edge_m());
    // Beyond this the box is too large anyhow, and no number may leave its type.
    const auto whole = [](double cells) {
      return static_cast<std::int64_t>(std::llround(std::clamp(cells, -1e15, 1e15)));
    };
    visit(Square{whole(corner.x()), whole(corner.y()), whole(leaf.edge_m() * map.lattice().cells_per_m())},
          what == Occupancy::kOccupied);
  });
}

/// A tile and the eight around it: what is occupied.
using Neighbourhood = std::array<std::array<std::uint8_t, 3 * kTile>, 3 * kTile>;

/// Squared distances [cells^2] of the columns of the tile in the middle, exact up to `radius` cells, which is at most
/// kTile: first along each row, then along each column of the picture.
std::array<int, kTileCells> squared_distances(const Neighbourhood& occupied, int radius) {
  constexpr int kNone = 1 << 20;
  constexpr int kSize = kTile;
  std::array<std::array<int, kTile>, 3 * kTile> along{};
  for (int row = kSize - radius; row < 2 * kSize + radius; ++row) {
    const auto& cells = occupied[static_cast<std::size_t>(row)];
    auto& squares = along[static_cast<std::size_t>(row)];
    int last = -kNone;
    for (int x = 0; x < 2 * kSize; ++x) {
      if (cells[static_cast<std::size_t>(x)] != 0) last = x;
      if (x >= kSize) squares[static_cast<std::size_t>(x - kSize)] = std::min(x - last, 1000);
    }
    last = kNone;
    for (int x = 3 * kSize - 1; x >= kSize; --x) {
      if (cells[static_cast<std::size_t>(x)] != 0) last = x;
      if (x >= 2 * kSize) continue;
      int& steps = squares[static_cast<std::size_t>(x - kSize)];
      steps = std::min(steps, last - x);
      steps = steps > radius ? kNone : steps * steps;
    }
  }
  std::array<int, kTileCells> squares{};
  for (std::size_t y = 0; y < kTile; ++y) {
    for (std::size_t x = 0; x < kTile; ++x) {
      int least = kNone;
      for (int off = 0; off <= radius && off * off < least; ++off) {
        const auto row = static_cast<int>(y) + kSize;
        least = std::min({least, along[static_cast<std::size_t>(row - off)][x] + off * off,
                          along[static_cast<std::size_t>(row + off)][x] + off * off});
      }
      squares[y * kTile + x] = least;
    }
  }
  return squares;
}

/// The columns of a layer that are known, in cells from the centre of the lattice.
struct LayerBounds {
  std::int64_t min_x = std::numeric_limits<std::int64_t>::max(), min_y = min_x, max_x = -min_x, max_y = -min_x;
  bool has_occupied = false;
};

LayerBounds layer_bounds(const OccupancyMap& map, const DistanceFieldOptions& options) {
  LayerBounds known;
  for_each_square(map, options, [&](const Square& s, bool is_occupied) {
    known.min_x = std::min(known.min_x, s.first_x);
    known.min_y = std::min(known.min_y, s.first_y);
    known.max_x = std::max(known.max_x, s.first_x + s.size);
    known.max_y = std::max(known.max_y, s.first_y + s.size);
    known.has_occupied |= is_occupied;
  });
  return known;
}

/// What is known of the columns in a box, in tiles that are made where something is.
class LayerTiles {
 public:
  LayerTiles(std::size_t tiles_x, std::size_t tiles_y) : tiles_x_(tiles_x), tiles_(tiles_x * tiles_y, 0) {}

  const std::vector<std::uint32_t>& tiles() const { return tiles_; }   ///< by place; 0: none
  const std::vector<std::uint8_t>& states() const { return states_; }  ///< tile by tile, the first of none
  std::size_t count() const { return has_occupied_.size(); }           ///< with the first of none

  /// Makes the tile at a place, if there is none. 0: there are too many.
  std::uint32_t make_tile(std::size_t place) {
    std::uint32_t& tile = tiles_[place];
    if (tile == 0 && has_occupied_.size() <= kMaxTiles) {
      tile = static_cast<std::uint32_t>(has_occupied_.size());
      has_occupied_.push_back(false);
      states_.resize(states_.size() + kTileCells, kNoCell);
    }
    return tile;
  }

  /// Takes columns, counted from the corner of the box. False: too many tiles.
  bool add(const Square& columns, bool is_occupied) {
    const std::int64_t x0 = columns.first_x, y0 = columns.first_y;
    for (std::int64_t ty = y0 / kTile; ty <= (y0 + columns.size - 1) / kTile; ++ty) {
      for (std::int64_t tx = x0 / kTile; tx <= (x0 + columns.size - 1) / kTile; ++tx) {
        const std::uint32_t tile = make_tile(static_cast<std::size_t>(ty) * tiles_x_ + static_cast<std::size_t>(tx));
        if (tile == 0) return false;
        if (is_occupied) has_occupied_[tile] = true;
        const std::uint8_t state = is_occupied ? kOccupiedCell : kFreeCell;
        for (std::int64_t y = std::max(y0, ty * kTile); y < std::min(y0 + columns.size, (ty + 1) * kTile); ++y) {
          for (std::int64_t x = std::max(x0, tx * kTile); x < std::min(x0 + columns.size, (tx + 1) * kTile); ++x) {
            std::uint8_t& cell = states_[tile * kTileCells + static_cast<std::size_t>((y % kTile) * kTile + x % kTile)];
            cell = std::max(cell, state);
          }
        }
      }
    }
    return true;
  }

  /// Places of the tiles with something occupied and of those next to them, which may hold nothing themselves.
  std::vector<std::size_t> near_occupied() const {
    std::vector<std::size_t> near;
    for (std::size_t place = 0; place < tiles_.size(); ++place) {
      if (!has_occupied_[tiles_[place]]) continue;
      for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) near.push_back(place + (row - 1) * tiles_x_ + column - 1);
      }
    }
    std::ranges::sort(near);
    near.erase(std::ranges::unique(near).begin(), near.end());
    return near;
  }

  void occupied_around(std::size_t place, Neighbourhood& occupied) const {
    for (std::size_t ty = 0; ty < 3; ++ty) {
      for (std::size_t tx = 0; tx < 3; ++tx) {
        const std::size_t other = place + (ty - 1) * tiles_x_ + tx - 1;
        const std::size_t tile = other < tiles_.size() ? tiles_[other] : 0;
        for (std::size_t i = 0; i < kTileCells; ++i) {
          occupied[ty * kTile + i / kTile][tx * kTile + i % kTile] = states_[tile * kTileCells + i] == kOccupiedCell;
        }
      }
    }
  }

 private:
  std::size_t tiles_x_;
  std::vector<std::uint32_t> tiles_;
  std::vector<std::uint8_t> states_ = std::vector<std::uint8_t>(kTileCells, kNoCell);
  std::vector<bool> has_occupied_ = std::vector<bool>(1, false);
};

}  // namespace

Result<void> DistanceFieldOptions::validate() const {
  OptionErrors errors;
  if (!std::isfinite(min_z_m) || !std::isfinite(max_z_m) || !(min_z_m < max_z_m)) {
    errors.add(fmt::format("min_z_m and max_z_m must be finite and rise, are {} and {}", min_z_m, max_z_m));
  }
  errors.require(truncation_m > 0.0 && std::isfinite(truncation_m), "truncation_m", "above 0 and finite", truncation_m);
  return errors.result("distance field");
}

Result<DistanceField> DistanceField::make(const OccupancyMap& map, const DistanceFieldOptions& options) {
  return detail::without_exceptions([&]() -> Result<DistanceField> {
    if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
    DistanceField field;
    field.cell_m_ = map.lattice().resolution_m();
    field.cells_per_m_ = map.lattice().cells_per_m();
    field.truncation_m_ = std::min(options.truncation_m, static_cast<double>(kTile) * field.cell_m_);
    field.step_m_ = field.truncation_m_ / kFar;

    LayerBounds known = layer_bounds(map, options);
    if (!known.has_occupied) {
      return fail(Error::Code::kUnsupported, fmt::format("nothing is occupied between the heights {:.3g} and {:.3g} m",
                                                         options.min_z_m, options.max_z_m));
    }
    // A tile around: distances go on there.
    known.min_x -= kTile;
    known.min_y -= kTile;
    const std::int64_t tiles_x = (known.max_x - known.min_x) / kTile + 2;
    const std::int64_t tiles_y = (known.max_y - known.min_y) / kTile + 2;
    const auto too_large = [&] {
      return fail(Error::Code::kLimit, fmt::format("the layer of the map between {:.3g} and {:.3g} m is too large",
                                                   options.min_z_m, options.max_z_m));
    };
    if (static_cast<double>(tiles_x) * static_cast<double>(tiles_y) > kMaxBoxTiles) return too_large();
    field.first_x_ = static_cast<double>(known.min_x);
    field.first_y_ = static_cast<double>(known.min_y);
    field.size_x_ = static_cast<double>(tiles_x * kTile);
    field.size_y_ = static_cast<double>(tiles_y * kTile);
    field.tiles_x_ = static_cast<std::size_t>(tiles_x);

    LayerTiles layer(field.tiles_x_, static_cast<std::size_t>(tiles_y));
    bool fits = true;
    for_each_square(map, options, [&](const Square& s, bool is_occupied) {
      fits = fits && layer.add({s.first_x - known.min_x, s.first_y - known.min_y, s.size}, is_occupied);
    });
    if (!fits) return too_large();
    const std::vector<std::size_t> near = layer.near_occupied();
    for (const std::size_t place : near) {
      if (layer.make_tile(place) == 0) return too_large();
    }
    field.tiles_ = layer.tiles();

    std::array<std::uint8_t, 2 * kTile * kTile + 1> steps{};
    for (std::size_t square = 0; square < steps.size(); ++square) {
      const double distance_m = std::sqrt(static_cast<double>(square)) * field.cell_m_;
      steps[square] = static_cast<std::uint8_t>(std::min<double>(kFar, std::round(distance_m / field.step_m_)));
    }
    const std::vector<std::uint8_t>& states = layer.states();
    field.values_.resize(states.size());
    std::ranges::transform(states, field.values_.begin(), [](std::uint8_t state) {
      return static_cast<std::uint8_t>(kFar + (state == kNoCell ? kUnknown : 0));
    });
    // A tile that is not near has nothing occupied beside it.
    field.clear_cells_.resize(layer.count() * kBlocks * kBlocks, kTile - 2);
    const auto occupied = std::make_unique<Neighbourhood>();
    for (const std::size_t place : near) {
      layer.occupied_around(place, *occupied);
      const auto squares = squared_distances(*occupied, kTile);
      const std::size_t first = field.tiles_[place] * kTileCells;
      for (std::size_t i = 0; i < kTileCells; ++i) {
        const auto square = static_cast<std::size_t>(squares[i]);
        // Less a diagonal: from the middle of a column to that of another is so much more than from point to point.
        const double clear = std::floor(std::sqrt(static_cast<double>(square)) - std::numbers::sqrt2);
        std::uint8_t& least = field.clear_cells_[field.block_of(field.tiles_[place], i % kTile, i / kTile)];
        least = static_cast<std::uint8_t>(std::clamp<double>(clear, 0.0, least));
        const std::uint8_t distance = square < steps.size() ? steps[square] : kFar;
        field.values_[first + i] = static_cast<std::uint8_t>(distance + (states[first + i] == kNoCell ? kUnknown : 0));
      }
    }
    return field;
  });
}

Occupancy DistanceField::classify(const Eigen::Vector2d& point_m) const {
  const std::uint8_t value = value_at(point_m.x(), point_m.y());
  if (value == 0) return Occupancy::kOccupied;
  return (value & kUnknown) != 0 ? Occupancy::kUnknown : Occupancy::kFree;
}

double DistanceField::clear_range_m(const Eigen::Vector2d& from_m, const Eigen::Vector2d& direction,
                                    double limit_m) const {
  // From the middle of a cell to that of another one is up to a diagonal more than from point to cell.
  const double surplus_m = std::numbers::sqrt2 * cell_m_ + step_m_;
  for (double range_m = 0.0; range_m < limit_m;) {
    const Eigen::Vector2d point_m = from_m + range_m * direction;
    const std::uint8_t value = value_at(point_m.x(), point_m.y());
    if (value == 0) return range_m;
    const bool is_far = (value & kFar) == kFar;
    range_m += std::max(is_far ? clear_m(point_m) : step_m_ * (value & kFar) - surplus_m, 0.5 * cell_m_);
  }
  return limit_m;
}

double DistanceField::clear_m(const Eigen::Vector2d& point_m) const {
  const double x = point_m.x() * cells_per_m_ - first_x_, y = point_m.y() * cells_per_m_ - first_y_;
  if (!(x >= 0.0 && x < size_x_ && y >= 0.0 && y < size_y_)) return 0.0;
  const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
  return cell_m_ * clear_cells_[block_of(tiles_[(j / kTile) * tiles_x_ + i / kTile], i % kTile, j % kTile)];
}

std::vector<Eigen::Vector2d> DistanceField::places(double step_m, double reach_m) const {
  // No step leads out of the box by more.
  const double most = std::max(size_x_, size_y_);
  const auto step = static_cast<std::size_t>(std::clamp(std::round(step_m * cells_per_m_), 1.0, most));
  const auto is_near_free = [&](const Eigen::Vector2d& place) {
    constexpr int kDirections = 16;
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDirections;
      const Eigen::Vector2d off(std::cos(angle), std::sin(angle));
      for (const double share : {0.25, 0.5, 0.75, 1.0}) {
        if (classify(place + share * reach_m * off) == Occupancy::kFree) return true;
      }
    }
    return false;
  };
  std::vector<Eigen::Vector2d> places;
  for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
    if (tiles_[tile] == 0) continue;
    const std::size_t x0 = tile % tiles_x_ * kTile, y0 = tile / tiles_x_ * kTile;
    const auto first = [&](std::size_t at) { return (at + step - 1) / step * step; };
    for (std::size_t y = first(y0); y < y0 + kTile; y += step) {
      for (std::size_t x = first(x0); x < x0 + kTile; x += step) {
        const Eigen::Vector2d place =
            Eigen::Vector2d(first_x_ + static_cast<double>(x) + 0.5, first_y_ + static_cast<double>(y) + 0.5) * cell_m_;
        const Occupancy what = classify(place);
        if (what == Occupancy::kFree || (what == Occupancy::kUnknown && reach_m > 0.0 && is_near_free(place))) {
          places.push_back(place);
        }
      }
    }
  }
  return places;
}

std::vector<Eigen::Vector2d> DistanceField::occupied() const {
  std::vector<Eigen::Vector2d> occupied;
  for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
    if (tiles_[tile] == 0) continue;
    for (std::size_t i = 0; i < kTileCells; ++i) {
      if (values_[tiles_[tile] * kTileCells + i] != 0) continue;
      const std::size_t x = tile % tiles_x_ * kTile + i % kTile, y = tile / tiles_x_ * kTile + i / kTile;
      occupied.emplace_back((first_x_ + static_cast<double>(x) + 0.5) * cell_m_,
                            (first_y_ + static_cast<double>(y) + 0.5) * cell_m_);
    }
  }
  return occupied;
}

double DistanceField::free_area_m2() const {
  const auto cells =
      std::ranges::count_if(values_, [](std::uint8_t value) { return value != 0 && (value & kUnknown) == 0; });
  return static_cast<double>(cells) * cell_m_ * cell_m_;
}

}  // namespace pingvox
