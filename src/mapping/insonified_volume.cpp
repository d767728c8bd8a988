#include "pingvox/mapping/insonified_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
/// one.
struct HalfSpace {
  explicit HalfSpace(const Vector& n)
      : normal(n), reach(0.5 * n.cwiseAbs().sum() + ((n.array() <= 0.0).all() ? kGrazing : -kGrazing)) {}
  Vector normal;
  double reach;
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
    faces_ = {HalfSpace(ahead), HalfSpace(std::sin(half_width) * ahead - std::cos(half_width) * left),
              HalfSpace(std::sin(half_width) * ahead + std::cos(half_width) * left),
              HalfSpace((slope * ahead - up).normalized()), HalfSpace((slope * ahead + up).normalized())};

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
  }

  const Vector& box_min() const { return box_min_; }
  const Vector& box_max() const { return box_max_; }

  /// Calls f(first cell, axis, number of cells) for each row of cells that the piece touches.
  template <class F>
  void for_each_row(F&& f) const {
    Vector at = Vector::Zero();
    std::array<std::int64_t, 3> cell{};
    const Run outer = cells_between(box_min_[outer_], box_max_[outer_], outer_);
    for (std::int64_t i = outer.first; i <= outer.last; ++i) {
      cell[index(outer_)] = i;
      at[outer_] = middle_of(i, outer_);
      at[middle_] = 0.0;
      const Run middle = touched(middle_, at, along_);
      for (std::int64_t j = middle.first; j <= middle.last; ++j) {
        cell[index(middle_)] = j;
        at[middle_] = middle_of(j, middle_);
        const Run row = in_sphere(at, touched(along_, at, -1));
        if (row.empty()) continue;
        cell[index(along_)] = row.first;
        f(cell, along_, static_cast<std::uint64_t>(row.last - row.first + 1));
      }
    }
  }

  Vector middle_of(const std::array<std::int64_t, 3>& cell) const {
    return {middle_of(cell[0], 0), middle_of(cell[1], 1), middle_of(cell[2], 2)};
  }

  /// Whether some part of a cell lies at the range of the echo or beyond.
  bool reaches_far_end(const Vector& middle) const {
    return (middle.cwiseAbs().array() + (0.5 + kGrazing)).matrix().squaredNorm() >= range_ * range_;
  }

 private:
  static std::size_t index(int axis) { return static_cast<std::size_t>(axis); }
  double middle_of(std::int64_t cell, int axis) const { return static_cast<double>(cell) + 0.5 - in_cell_[axis]; }
  /// Cells along an axis with their middles between two places.
  Run cells_between(double low, double high, int axis) const {
    return {static_cast<std::int64_t>(std::ceil(low - 0.5 + in_cell_[axis])),
            static_cast<std::int64_t>(std::floor(high - 0.5 + in_cell_[axis]))};
  }

  /// Cells of the line along `axis` through `at` (whose component along it must be 0) that touch all half-spaces; with
  /// an `open` axis (else -1): that do so somewhere along that one, too.
  Run touched(int axis, const Vector& at, int open) const {
    double low = box_min_[axis], high = box_max_[axis];
    for (const HalfSpace& face : faces_) {
      double needed = -face.reach - face.normal.dot(with_zero(at, axis, open));
      if (open >= 0) needed -= std::max(face.normal[open] * box_min_[open], face.normal[open] * box_max_[open]);
      const double slope = face.normal[axis];
      if (slope > 0.0) {
        low = std::max(low, needed / slope);
      } else if (slope < 0.0) {
        high = std::min(high, needed / slope);
      } else if (needed > 0.0) {
        return {0, -1};
      }
    }
    // Outside of the box nothing is meant, and huge numbers are no cells.
    return low > high ? Run{0, -1} : cells_between(low, high, axis);
  }

  static Vector with_zero(Vector at, int axis, int other) {
    at[axis] = 0.0;
    if (other >= 0) at[other] = 0.0;
    return at;
  }

  /// What of a row along along_ the sphere touches.
  Run in_sphere(const Vector& at, Run row) const {
    const double outer = std::max(0.0, std::abs(at[outer_]) - 0.5), middle = std::max(0.0, std::abs(at[middle_]) - 0.5);
    const double left = range_ * range_ - outer * outer - middle * middle;
    if (left < 0.0 || row.empty()) return {0, -1};
    const double reach = std::sqrt(left) + 0.5 + kGrazing;
    const Run sphere = cells_between(-reach, reach, along_);
    return {std::max(row.first, sphere.first), std::min(row.last, sphere.last)};
  }

  double range_;
  Vector in_cell_;  ///< the sensor in its cell, each component in [0, 1)
  std::array<HalfSpace, 5> faces_{HalfSpace(Vector::Zero()), HalfSpace(Vector::Zero()), HalfSpace(Vector::Zero()),
                                  HalfSpace(Vector::Zero()), HalfSpace(Vector::Zero())};
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

bool trace_volume(const Lattice& lattice, const InsonifiedVolume& volume,
                  const std::function<LogOdds(double elevation_rad)>& evidence_of, ScanUpdate& scan) {
  assert(volume.range_m > 0.0 && volume.width_rad >= 0.0 && volume.height_rad >= 0.0);
  const Vector origin_m = volume.map_from_sensor.translation();
  const auto origin_key = lattice.key_of<WideWord>(origin_m);
  if (!origin_key) return false;
  const double edge_m = lattice.resolution_m();
  const Vector origin = origin_m / edge_m;
  const Vector in_cell = origin.array() - origin.array().floor();
  const Vector up = volume.map_from_sensor.linear() * Vector::UnitZ();

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
    piece.for_each_row([&](std::array<std::int64_t, 3> cell, int axis, std::uint64_t length) {
      scan.add_missed_run(moved(*origin_key, cell), axis, length);
      const Vector first = piece.middle_of(cell);
      Vector last = first;
      last[axis] += static_cast<double>(length - 1);
      // The farthest cell of a row is at one of its ends.
      if (!evidence_of || !(piece.reaches_far_end(first) || piece.reaches_far_end(last))) return;
      for (std::uint64_t i = 0; i < length; ++i, ++cell[static_cast<std::size_t>(axis)]) {
        const Vector middle = piece.middle_of(cell);
        if (!piece.reaches_far_end(middle)) continue;
        const double elevation = std::asin(std::clamp(up.dot(middle.normalized()), -1.0, 1.0));
        scan.add_hit(moved(*origin_key, cell), evidence_of(elevation));
      }
    });
  }
  return true;
}

}  // namespace pingvox
