#include "pingvox/mapping/insonified_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace pingvox {
namespace {

/// Lengths are in cells from here on, seen from the sensor; cell (i, j, k) counts from the one that the sensor is in.
using Vector = Eigen::Vector3d;

// A wedge wider than this is cut up: the cones above and below it are taken as planes, which are too wide by
// tan(height / 2) * (1 / cos(piece / 2) - 1) of the range: 0.3 mm in a metre for 5 degrees and a height of 35.
constexpr double kWidestPiece_rad = 5.0 * std::numbers::pi / 180.0;
// Rounding must not decide whether a face touches a cell [cells].
constexpr double kGrazing = 1e-9;

/// The half-space normal * p >= 0, for whole cells: one with its middle at c touches it when normal * c >= -reach.
/// Cells are closed below and open above, so a fan that lies exactly between two layers of cells belongs to the upper
/// one. Axes are those of the walk: of layers, of rows in a layer, of cells in a row.
struct Face {
  double layer = 0.0, row = 0.0, cell = 0.0;  ///< components of the normal
  double row_way = 0.0, cell_way = 0.0;       ///< 1 / row, 1 / cell
  double reach = 0.0;
  double most_along_row = 0.0;  ///< the most that `cell` times a place within the box can be
};

/// Cells first..last along an axis.
struct Run {
  std::int64_t first, last;
  bool empty() const { return first > last; }
};

/// A convex piece of the volume. Its rows of cells run along the map axis nearest to the head's own up, because a beam
/// is tall and thin: so there are few of them.
class Piece {
 public:
  Piece(const Pose& map_from_sensor, double bearing_rad, double width_rad, double height_rad, double range,
        const Vector& in_cell)
      : range_(range), in_cell_(in_cell) {
    const auto direction = [&](double azimuth, double elevation) -> Vector {
      return map_from_sensor.linear() * Vector(std::cos(elevation) * std::cos(bearing_rad + azimuth),
                                               std::cos(elevation) * std::sin(bearing_rad + azimuth),
                                               std::sin(elevation));
    };
    const Vector ahead = direction(0.0, 0.0), left = direction(std::numbers::pi / 2, 0.0);
    const Vector up = map_from_sensor.linear() * Vector::UnitZ();
    const double half_width = width_rad / 2, half_height = height_rad / 2;
    const double slope = std::tan(half_height) / std::cos(half_width);
    const std::array<Vector, 5> normals{ahead, std::sin(half_width) * ahead - std::cos(half_width) * left,
                                        std::sin(half_width) * ahead + std::cos(half_width) * left,
                                        (slope * ahead - up).normalized(), (slope * ahead + up).normalized()};

    const Vector& tall = height_rad >= width_rad ? up : ahead;
    const Vector& deep = height_rad >= width_rad ? ahead : left;
    tall.cwiseAbs().maxCoeff(&along_);
    const int one = (along_ + 1) % 3, other = (along_ + 2) % 3;
    outer_ = std::abs(deep[one]) >= std::abs(deep[other]) ? one : other;
    middle_ = outer_ == one ? other : one;

    // The box around the sensor and the far end. Between samples the sphere bulges by no more than `bulge`.
    constexpr int kSamples = 8;
    box_min_ = box_max_ = Vector::Zero();
    for (int i = 0; i <= kSamples; ++i) {
      for (const double azimuth : {-half_width, 0.0, half_width}) {
        const Vector end = range * direction(azimuth, height_rad * (static_cast<double>(i) / kSamples - 0.5));
        box_min_ = box_min_.cwiseMin(end);
        box_max_ = box_max_.cwiseMax(end);
      }
    }
    const double step = std::max(height_rad / kSamples, half_width);
    const double bulge = range * (1.0 - std::cos(step)) + 1.0;
    box_min_.array() -= bulge;
    box_max_.array() += bulge;
    for (std::size_t i = 0; i < faces_.size(); ++i) faces_[i] = face_of(normals[i]);
  }

  const Vector& box_min() const { return box_min_; }
  const Vector& box_max() const { return box_max_; }

  /// Calls f(first cell, axis, number of cells) for each row of cells that the piece touches.
  template <class F>
  void for_each_row(F&& f) const {
    std::array<std::int64_t, 3> cell{};
    std::array<double, 5> needed{};
    const Run layers = cells_between(box_min_[outer_], box_max_[outer_], outer_);
    for (std::int64_t i = layers.first; i <= layers.last; ++i) {
      cell[index(outer_)] = i;
      const double layer = middle_of(i, outer_);
      for (std::size_t n = 0; n < faces_.size(); ++n) needed[n] = -faces_[n].reach - faces_[n].layer * layer;
      const Run rows = rows_touched(needed);
      for (std::int64_t j = rows.first; j <= rows.last; ++j) {
        cell[index(middle_)] = j;
        const double row = middle_of(j, middle_);
        const Run cells = in_sphere(layer, row, cells_touched(needed, row));
        if (cells.empty()) continue;
        cell[index(along_)] = cells.first;
        f(cell, along_, static_cast<std::uint64_t>(cells.last - cells.first + 1));
      }
    }
  }

 private:
  static std::size_t index(int axis) { return static_cast<std::size_t>(axis); }
  double middle_of(std::int64_t cell, int axis) const { return static_cast<double>(cell) + 0.5 - in_cell_[axis]; }
  /// Cells along an axis with their middles between two places.
  Run cells_between(double low, double high, int axis) const {
    return {static_cast<std::int64_t>(std::ceil(low - 0.5 + in_cell_[axis])),
            static_cast<std::int64_t>(std::floor(high - 0.5 + in_cell_[axis]))};
  }

  Face face_of(const Vector& normal) const {
    Face face;
    face.layer = normal[outer_];
    face.row = normal[middle_];
    face.cell = normal[along_];
    face.row_way = 1.0 / face.row;
    face.cell_way = 1.0 / face.cell;
    face.reach = 0.5 * normal.cwiseAbs().sum() + ((normal.array() <= 0.0).all() ? kGrazing : -kGrazing);
    face.most_along_row = std::max(face.cell * box_min_[along_], face.cell * box_max_[along_]);
    return face;
  }

  /// Narrows low..high to where slope * place >= needed; `way` is 1 / slope.
  static void narrow(double slope, double way, double needed, double& low, double& high) {
    if (slope > 0.0) {
      low = std::max(low, needed * way);
    } else if (slope < 0.0) {
      high = std::min(high, needed * way);
    } else if (needed > 0.0) {
      high = -std::numeric_limits<double>::infinity();
    }
  }

  /// Rows of a layer that touch all half-spaces somewhere. @param needed  of each face, what the layer leaves to reach
  Run rows_touched(const std::array<double, 5>& needed) const {
    double low = box_min_[middle_], high = box_max_[middle_];
    for (std::size_t n = 0; n < faces_.size(); ++n) {
      narrow(faces_[n].row, faces_[n].row_way, needed[n] - faces_[n].most_along_row, low, high);
    }
    return low > high ? Run{0, -1} : cells_between(low, high, middle_);
  }

  /// Cells of a row that touch all half-spaces.
  Run cells_touched(const std::array<double, 5>& needed, double row) const {
    double low = box_min_[along_], high = box_max_[along_];
    for (std::size_t n = 0; n < faces_.size(); ++n) {
      narrow(faces_[n].cell, faces_[n].cell_way, needed[n] - faces_[n].row * row, low, high);
    }
    // Outside of the box nothing is meant, and huge numbers are no cells.
    return low > high ? Run{0, -1} : cells_between(low, high, along_);
  }

  /// What of a row the sphere touches.
  Run in_sphere(double layer, double row, const Run& cells) const {
    const double outer = std::max(0.0, std::abs(layer) - 0.5), middle = std::max(0.0, std::abs(row) - 0.5);
    const double left = range_ * range_ - outer * outer - middle * middle;
    if (left < 0.0 || cells.empty()) return {0, -1};
    const double reach = std::sqrt(left) + 0.5 + kGrazing;
    const Run sphere = cells_between(-reach, reach, along_);
    return {std::max(cells.first, sphere.first), std::min(cells.last, sphere.last)};
  }

  double range_;
  Vector in_cell_;  ///< the sensor in its cell, each component in [0, 1)
  std::array<Face, 5> faces_;
  int outer_ = 0, middle_ = 1, along_ = 2;  ///< map axes: of layers, of rows in them, of rows' cells
  Vector box_min_, box_max_;
};

WideKey moved(const WideKey& from, const std::array<std::int64_t, 3>& by) {
  const auto word = [](WideWord w, std::int64_t n) {
    return n < 0 ? w - static_cast<WideWord>(-n) : w + static_cast<WideWord>(n);
  };
  return {word(from.x, by[0]), word(from.y, by[1]), word(from.z, by[2])};
}

}  // namespace

bool trace_volume(const Lattice& lattice, const InsonifiedVolume& volume, ScanUpdate& scan) {
  assert(volume.range_m > 0.0 && volume.width_rad >= 0.0 && volume.height_rad >= 0.0);
  const Vector origin_m = volume.map_from_sensor.translation();
  const auto origin_key = lattice.key_of<WideWord>(origin_m);
  if (!origin_key) return false;
  const double edge_m = lattice.resolution_m();
  const Vector origin = origin_m / edge_m;
  const Vector in_cell = origin.array() - origin.array().floor();

  const auto count = static_cast<int>(std::max(1.0, std::ceil(volume.width_rad / kWidestPiece_rad)));
  std::vector<Piece> pieces;
  for (int i = 0; i < count; ++i) {
    const double width = volume.width_rad / count;
    const double bearing = volume.bearing_rad + (i + 0.5) * width - volume.width_rad / 2;
    pieces.emplace_back(volume.map_from_sensor, bearing, width, volume.height_rad, volume.range_m / edge_m, in_cell);
    const Vector low_m = origin_m + (pieces.back().box_min().array() - 1.0).matrix() * edge_m;
    const Vector high_m = origin_m + (pieces.back().box_max().array() + 1.0).matrix() * edge_m;
    if (!lattice.key_of<WideWord>(low_m) || !lattice.key_of<WideWord>(high_m)) return false;
  }
  for (const Piece& piece : pieces) {
    piece.for_each_row([&](const std::array<std::int64_t, 3>& cell, int axis, std::uint64_t length) {
      scan.add_missed_run(moved(*origin_key, cell), axis, length);
    });
  }
  return true;
}

}  // namespace pingvox
