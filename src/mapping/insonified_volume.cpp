#include "mapping/internal/insonified_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mapping/brick_column.hpp"
#include "mapping/kernels/convex_rows.hpp"
#include "pingvox/geometry/degree.hpp"

namespace pingvox {
namespace {

/// Lengths are in cells from here on, seen from the sensor; cell (i, j, k) counts from the one that the sensor is in.
using Vector = Eigen::Vector3d;

// A wedge wider than this is cut up: the cones above and below it are taken as planes, which are too wide by
// tan(height / 2) * (1 / cos(piece / 2) - 1) of the range: 0.3 mm in a metre for 5 degrees and a height of 35.
constexpr double kWidestPiece_rad = 5.0 * kDegree_rad;
using detail::WalkAxes;

constexpr std::int64_t kPage = 1 << ScanUpdate::kPageBits;
constexpr std::int64_t kLayers = detail::RowsOfLayers::kLayers;

/// Cells first..last along an axis.
struct Run {
  std::int64_t first, last;
};

/// An angle with its sine and cosine.
struct Angle {
  double cos, sin;
  explicit Angle(double rad) : cos(std::cos(rad)), sin(std::sin(rad)) {}
};

/// A convex piece of the volume. Its rows of cells run along the map axis nearest to the head's up direction: a beam is
/// tall and thin, so there are few rows.
class Piece {
 public:
  Piece(const Pose& map_from_sensor, double bearing_rad, double width_rad, double height_rad, double range,
        const Vector& in_cell)
      : in_cell_(in_cell) {
    const auto direction = [&](const Angle& azimuth, const Angle& elevation) -> Vector {
      return map_from_sensor.linear() * Vector(elevation.cos * azimuth.cos, elevation.cos * azimuth.sin, elevation.sin);
    };
    const double half_width = width_rad / 2, half_height = height_rad / 2;
    const Angle level(0.0);
    const std::array<Angle, 3> azimuths{Angle(bearing_rad - half_width), Angle(bearing_rad),
                                        Angle(bearing_rad + half_width)};
    const Vector ahead = direction(azimuths[1], level);
    const Vector left = direction(Angle(bearing_rad + std::numbers::pi / 2), level);
    const Vector up = map_from_sensor.linear() * Vector::UnitZ();
    const double slope = std::tan(half_height) / std::cos(half_width);
    const Angle across(half_width);
    const std::array<Vector, 5> normals{ahead, across.sin * ahead - across.cos * left,
                                        across.sin * ahead + across.cos * left, (slope * ahead - up).normalized(),
                                        (slope * ahead + up).normalized()};

    const Vector& tall = height_rad >= width_rad ? up : ahead;
    const Vector& deep = height_rad >= width_rad ? ahead : left;
    tall.cwiseAbs().maxCoeff(&order_.cell);
    const int one = (order_.cell + 1) % 3, other = (order_.cell + 2) % 3;
    order_.layer = std::abs(deep[one]) >= std::abs(deep[other]) ? one : other;
    order_.row = order_.layer == one ? other : one;

    // The box around the sensor and the far end. Between samples the sphere bulges by no more than `bulge`.
    constexpr int kSamples = 8;
    box_min_ = box_max_ = Vector::Zero();
    for (int i = 0; i <= kSamples; ++i) {
      const Angle elevation(height_rad * (static_cast<double>(i) / kSamples - 0.5));
      for (const Angle& azimuth : azimuths) {
        const Vector end = range * direction(azimuth, elevation);
        box_min_ = box_min_.cwiseMin(end);
        box_max_ = box_max_.cwiseMax(end);
      }
    }
    const double step = std::max(height_rad / kSamples, half_width);
    const double bulge = range * (1.0 - std::cos(step)) + 1.0;
    box_min_.array() -= bulge;
    box_max_.array() += bulge;

    body_.range = range;
    body_.in_cell = in_walk(in_cell);
    body_.low = in_walk(box_min_);
    body_.high = in_walk(box_max_);
    for (std::size_t i = 0; i < normals.size(); ++i) body_.faces[i] = face_of(normals[i]);
  }

  const Vector& box_min() const { return box_min_; }
  const Vector& box_max() const { return box_max_; }

  /// Marks the cells that the piece touches, by columns of bricks: of four layers at a time, four rows at a time.
  void mark(const WideKey& origin, ScanUpdate& scan) const {
    const Run layers = cells_in_box(order_.layer), cells = cells_in_box(order_.cell);
    detail::ColumnOfRows column;
    // Columns begin with a page, and a brick at least below the lowest cell: places below 4 are for rows without cells.
    column.lowest_cell = align_down(cells.first - 4, kPage, origin, order_.cell);
    detail::BrickColumn bricks(order_, static_cast<std::size_t>(cells.last + 1 - column.lowest_cell));
    column.no_place = bricks.no_place();
    const std::int64_t lowest_layer = align_down(layers.first, kPage, origin, order_.layer);
    for (std::int64_t first = lowest_layer; first <= layers.last; first += kLayers) {
      const detail::RowsOfLayers rows = rows_of(first, layers);
      for (std::int64_t l = 0; l < kLayers; l += 4) {
        column.first_layer = first + l;
        column.first_of_layer = rows.first.data() + l;
        column.last_of_layer = rows.last.data() + l;
        mark_layers(column, bricks, origin, scan);
      }
    }
  }

 private:
  WalkAxes in_walk(const Vector& v) const { return {v[order_.layer], v[order_.row], v[order_.cell]}; }

  /// Cells along an axis with their middles in the box.
  Run cells_in_box(int axis) const {
    return {static_cast<std::int64_t>(std::ceil(box_min_[axis] - 0.5 + in_cell_[axis])),
            static_cast<std::int64_t>(std::floor(box_max_[axis] - 0.5 + in_cell_[axis]))};
  }

  /// The rows of the layers from `first` on that are among `layers`.
  detail::RowsOfLayers rows_of(std::int64_t first, const Run& layers) const {
    detail::RowsOfLayers rows;
    detail::find_rows(body_, first, rows);
    for (std::size_t l = 0; l < detail::RowsOfLayers::kLayers; ++l) {
      const std::int64_t layer = first + static_cast<std::int64_t>(l);
      if (layer < layers.first || layer > layers.last) rows.last[l] = rows.first[l] - 1.0;
    }
    return rows;
  }

  /// Marks the cells of four layers, column by column.
  void mark_layers(detail::ColumnOfRows& column, detail::BrickColumn& bricks, const WideKey& origin,
                   ScanUpdate& scan) const {
    const Run rows = rows_of_all(column);
    if (rows.first > rows.last) return;
    detail::RunsOfRows runs;
    const std::int64_t lowest_row = align_down(rows.first, 4, origin, order_.row);
    for (column.first_row = lowest_row; column.first_row <= rows.last; column.first_row += 4) {
      detail::find_cells(body_, column, runs);
      bricks.mark(runs, lowest_key(column, origin), scan);
    }
  }

  /// The rows that count in any layer of a column.
  static Run rows_of_all(const detail::ColumnOfRows& column) {
    double first = std::numeric_limits<double>::max(), last = -first;
    for (std::size_t l = 0; l < 4; ++l) {
      if (column.first_of_layer[l] > column.last_of_layer[l]) continue;
      first = std::min(first, column.first_of_layer[l]);
      last = std::max(last, column.last_of_layer[l]);
    }
    if (first > last) return {0, -1};
    return {static_cast<std::int64_t>(first), static_cast<std::int64_t>(last)};
  }

  /// The lowest of the `size` cells along an axis that belong together, of which this is one.
  static std::int64_t align_down(std::int64_t cell, std::int64_t size, const WideKey& origin, int axis) {
    const WideWord word = axis == 0 ? origin.x : (axis == 1 ? origin.y : origin.z);
    return cell - ((cell + static_cast<std::int64_t>(word & (kPage - 1))) & (size - 1));
  }

  WideKey lowest_key(const detail::ColumnOfRows& column, const WideKey& origin) const {
    std::array<std::int64_t, 3> cell{};
    cell[static_cast<std::size_t>(order_.layer)] = column.first_layer;
    cell[static_cast<std::size_t>(order_.row)] = column.first_row;
    cell[static_cast<std::size_t>(order_.cell)] = column.lowest_cell;
    // Unsigned sums wrap, so negative numbers are subtracted.
    return {origin.x + static_cast<WideWord>(cell[0]), origin.y + static_cast<WideWord>(cell[1]),
            origin.z + static_cast<WideWord>(cell[2])};
  }

  detail::Face face_of(const Vector& normal) const {
    detail::Face face;
    face.normal = in_walk(normal);
    face.row_way = 1.0 / face.normal.row;
    face.cell_way = 1.0 / face.normal.cell;
    // Cells are closed below and open above, so a fan that lies exactly between two layers of cells belongs to the
    // upper one.
    face.reach = 0.5 * normal.cwiseAbs().sum() + ((normal.array() <= 0.0).all() ? detail::kGrazing : -detail::kGrazing);
    face.max_along_row = std::max(face.normal.cell * body_.low.cell, face.normal.cell * body_.high.cell);
    return face;
  }

  Vector in_cell_;  ///< the sensor in its cell, each component in [0, 1)
  detail::WalkOrder order_;
  Vector box_min_, box_max_;
  detail::ConvexBody body_;
};

}  // namespace

bool trace_volume(const InsonifiedVolume& volume, ScanUpdate& scan) {
  const Lattice& lattice = scan.lattice();
  assert(volume.range_m > 0.0 && volume.width_rad >= 0.0 && volume.height_rad >= 0.0);
  const Vector origin_m = volume.map_from_sensor.translation();
  const auto origin_key = lattice.key_of<WideWord>(origin_m);
  if (!origin_key) return false;
  const double edge_m = lattice.resolution_m();
  const Vector origin = lattice.in_cells(origin_m);
  const Vector in_cell = origin.array() - origin.array().floor();
  const double range = volume.range_m * lattice.cells_per_m();

  const auto count = static_cast<int>(std::max(1.0, std::ceil(volume.width_rad / kWidestPiece_rad)));
  std::vector<Piece> pieces;
  for (int i = 0; i < count; ++i) {
    const double width = volume.width_rad / count;
    const double bearing = volume.bearing_rad + (i + 0.5) * width - volume.width_rad / 2;
    pieces.emplace_back(volume.map_from_sensor, bearing, width, volume.height_rad, range, in_cell);
    const Vector low_m = origin_m + (pieces.back().box_min().array() - 1.0).matrix() * edge_m;
    const Vector high_m = origin_m + (pieces.back().box_max().array() + 1.0).matrix() * edge_m;
    if (!lattice.key_of<WideWord>(low_m) || !lattice.key_of<WideWord>(high_m)) return false;
  }
  for (const Piece& piece : pieces) piece.mark(*origin_key, scan);
  return true;
}

}  // namespace pingvox
