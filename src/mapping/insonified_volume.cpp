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

/// Where a row of cells along `axis` lies, and which of its cells are meant: [first, last].
struct Run {
  std::int64_t first, last;
  bool empty() const { return first > last; }
};

/// A convex piece of the volume, and the map axis that its rows run along.
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
    ahead.cwiseAbs().maxCoeff(&axis_);
    is_forward_ = ahead[axis_] > 0.0;

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

  int axis() const { return axis_; }
  const Vector& box_min() const { return box_min_; }
  const Vector& box_max() const { return box_max_; }
  std::int64_t first_cell(int axis) const { return cell_at(box_min_[axis], axis); }
  std::int64_t last_cell(int axis) const { return cell_at(box_max_[axis], axis); }
  /// Middle of a cell along one axis.
  double middle(std::int64_t cell, int axis) const { return static_cast<double>(cell) + 0.5 - in_cell_[axis]; }

  struct Row {
    Run all;  ///< cells that the piece touches
    Run far;  ///< those of them that the sphere of its far end passes through
  };

  /// The row through `at`, whose component along axis() does not matter.
  Row row(Vector at) const {
    constexpr Run kNothing{0, -1};
    at[axis_] = 0.0;
    double low = box_min_[axis_], high = box_max_[axis_];
    for (const HalfSpace& face : faces_) {
      const double needed = -face.reach - face.normal.dot(at);
      const double slope = face.normal[axis_];
      if (slope > 0.0) {
        low = std::max(low, needed / slope);
      } else if (slope < 0.0) {
        high = std::min(high, needed / slope);
      } else if (needed > 0.0) {
        return {kNothing, kNothing};
      }
    }
    // Nearest and farthest points of the row's cells from the sensor, across the row.
    double nearest = 0.0, farthest = 0.0;
    for (int other = 0; other < 3; ++other) {
      if (other == axis_) continue;
      const double off = std::abs(at[other]);
      nearest += std::pow(std::max(0.0, off - 0.5), 2);
      farthest += std::pow(off + 0.5, 2);
    }
    const double left = range_ * range_ - nearest;
    if (left < 0.0) return {kNothing, kNothing};
    const double leaves = std::sqrt(left) + kGrazing;
    const double enters = std::sqrt(std::max(0.0, range_ * range_ - farthest)) - kGrazing;
    low = std::max(low, -leaves - 0.5);
    high = std::min(high, leaves + 0.5);
    if (low > high) return {kNothing, kNothing};
    const Run all{first_middle_from(low), last_middle_to(high)};
    const Run far = is_forward_ ? Run{std::max(all.first, first_middle_from(enters - 0.5)), all.last}
                                : Run{all.first, std::min(all.last, last_middle_to(0.5 - enters))};
    return {all, far};
  }

 private:
  std::int64_t cell_at(double place, int axis) const {
    return static_cast<std::int64_t>(std::floor(place + in_cell_[axis]));
  }
  std::int64_t first_middle_from(double place) const {
    return static_cast<std::int64_t>(std::ceil(place - 0.5 + in_cell_[axis_]));
  }
  std::int64_t last_middle_to(double place) const {
    return static_cast<std::int64_t>(std::floor(place - 0.5 + in_cell_[axis_]));
  }

  double range_;
  Vector in_cell_;  ///< the sensor in its cell, each component in [0, 1)
  std::array<HalfSpace, 5> faces_{HalfSpace(Vector::Zero()), HalfSpace(Vector::Zero()), HalfSpace(Vector::Zero()),
                                  HalfSpace(Vector::Zero()), HalfSpace(Vector::Zero())};
  int axis_ = 0;
  bool is_forward_ = true;
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
    const int along = piece.axis(), a = (along + 1) % 3, b = (along + 2) % 3;
    const auto index = [](int axis) { return static_cast<std::size_t>(axis); };
    std::array<std::int64_t, 3> cell{};
    Vector middle = Vector::Zero();
    for (cell[index(a)] = piece.first_cell(a); cell[index(a)] <= piece.last_cell(a); ++cell[index(a)]) {
      middle[a] = piece.middle(cell[index(a)], a);
      for (cell[index(b)] = piece.first_cell(b); cell[index(b)] <= piece.last_cell(b); ++cell[index(b)]) {
        middle[b] = piece.middle(cell[index(b)], b);
        const Piece::Row row = piece.row(middle);
        if (row.all.empty()) continue;
        cell[index(along)] = row.all.first;
        const auto length = static_cast<std::uint64_t>(row.all.last - row.all.first + 1);
        scan.add_missed_run(moved(*origin_key, cell), along, length);
        if (!evidence_of) continue;
        for (std::int64_t i = row.far.first; i <= row.far.last; ++i) {
          cell[index(along)] = i;
          middle[along] = piece.middle(i, along);
          const double elevation = std::asin(std::clamp(up.dot(middle.normalized()), -1.0, 1.0));
          scan.add_hit(moved(*origin_key, cell), evidence_of(elevation));
        }
      }
    }
  }
  return true;
}

}  // namespace pingvox
