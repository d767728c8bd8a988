#include "line_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace pingvox::bench {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Echoes of a line, as far as the line depends on them.
struct Moments {
  double count = 0.0;
  Vector2d mean = Vector2d::Zero();
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();  ///< sum of the squares of offsets from the mean

  void add(const Moments& other) {
    const double sum = count + other.count;
    const Vector2d apart = other.mean - mean;
    scatter += other.scatter + count * other.count / sum * apart * apart.transpose();
    mean += other.count / sum * apart;
    count = sum;
  }
};

/// A line and the part of it that echoes came from.
struct Piece {
  Moments moments;
  Vector2d direction = Vector2d::UnitX();  ///< of length 1
  Vector2d from = Vector2d::Zero(), to = Vector2d::Zero();
  double deviation = 0.0;
  std::size_t first_sweep = 0, last_sweep = 0;  ///< that saw it

  double length() const { return (to - from).norm(); }
  double across(const Vector2d& point) const { return std::abs(cross(direction, point - moments.mean)); }
  double along(const Vector2d& point) const { return direction.dot(point - moments.mean); }
};

/// The line through moments, from the first to the last of some points along it.
Piece fit(const Moments& moments, std::span<const Vector2d> points) {
  Piece piece;
  piece.moments = moments;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(moments.scatter);  // the smallest first
  piece.direction = axes.eigenvectors().col(1);
  piece.deviation = std::sqrt(std::max(0.0, axes.eigenvalues()[0]) / moments.count);
  double first = std::numeric_limits<double>::max(), last = -first;
  for (const Vector2d& point : points) {
    first = std::min(first, piece.along(point));
    last = std::max(last, piece.along(point));
  }
  piece.from = moments.mean + first * piece.direction;
  piece.to = moments.mean + last * piece.direction;
  return piece;
}

/// Splits echoes at the one farthest from the chord until all are near.
void split(std::span<const Vector2d> points, const LineOptions& options, std::vector<Piece>& pieces) {
  if (points.size() < options.min_echoes) return;
  const Vector2d chord = points.back() - points.front();
  const double length = chord.norm();
  std::size_t farthest = 0;
  double distance = 0.0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vector2d offset = points[i] - points.front();
    const double here = length > 0.0 ? std::abs(cross(chord, offset)) / length : offset.norm();
    if (here > distance) std::tie(farthest, distance) = std::pair(i, here);
  }
  if (distance > options.max_across_m) {
    split(points.first(farthest + 1), options, pieces);
    split(points.subspan(farthest), options, pieces);
    return;
  }
  Moments moments;
  for (const Vector2d& point : points) moments.add({1.0, point, Eigen::Matrix2d::Zero()});
  const Piece piece = fit(moments, points);
  if (piece.length() >= options.min_length_m) pieces.push_back(piece);
}

/// The line of two pieces, if one line fits both and no gap is between them.
std::optional<Piece> merge(const Piece& a, const Piece& b, const LineOptions& options) {
  const Vector2d ends[] = {a.from, a.to, b.from, b.to};
  Moments moments = a.moments;
  moments.add(b.moments);
  Piece both = fit(moments, ends);
  for (const Vector2d& end : ends) {
    if (both.across(end) > options.max_across_m) return std::nullopt;
  }
  if (both.length() > a.length() + b.length() + options.max_gap_m) return std::nullopt;
  both.first_sweep = std::min(a.first_sweep, b.first_sweep);
  both.last_sweep = std::max(a.last_sweep, b.last_sweep);
  return both;
}

/// Merges pieces until no two of them are of one line.
std::vector<Piece> merge_all(const std::vector<Piece>& pieces, const LineOptions& options) {
  std::vector<Piece> lines;
  for (Piece piece : pieces) {
    for (std::size_t i = 0; i < lines.size();) {
      const auto both = merge(lines[i], piece, options);
      if (!both) {
        ++i;
        continue;
      }
      // The longer line may reach others that it was too far from.
      piece = *both;
      lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    }
    lines.push_back(piece);
  }
  return lines;
}

/// Lets walls end where they meet.
std::vector<Corner> corners_of(std::vector<Piece>& lines, const LineOptions& options) {
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      Piece &a = lines[i], &b = lines[j];
      const double sine = cross(a.direction, b.direction);
      if (std::abs(sine) < std::sin(options.min_corner_rad)) continue;
      const double along = cross(b.moments.mean - a.moments.mean, b.direction) / sine;
      const Vector2d place = a.moments.mean + along * a.direction;
      const auto nearer = [&](Piece& piece) -> Vector2d& {
        return (piece.from - place).norm() < (piece.to - place).norm() ? piece.from : piece.to;
      };
      Vector2d &end = nearer(a), &other = nearer(b);
      if (std::max((end - place).norm(), (other - place).norm()) > options.max_corner_m) continue;
      end = other = place;
      corners.push_back({place, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
    }
  }
  return corners;
}

}  // namespace

LineMap extract_lines(std::span<const std::vector<Vector2d>> sweeps, const LineOptions& options) {
  std::vector<Piece> pieces;
  for (std::size_t n = 0; n < sweeps.size(); ++n) {
    const std::span<const Vector2d> sweep = sweeps[n];
    const std::size_t before = pieces.size();
    std::size_t first = 0;
    for (std::size_t i = 1; i <= sweep.size(); ++i) {
      if (i < sweep.size() && (sweep[i] - sweep[i - 1]).norm() <= options.max_gap_m) continue;
      split(sweep.subspan(first, i - first), options, pieces);
      first = i;
    }
    for (Piece& piece : std::span(pieces).subspan(before)) piece.first_sweep = piece.last_sweep = n;
  }
  std::vector<Piece> lines = merge_all(pieces, options);
  if (sweeps.size() > 1) std::erase_if(lines, [](const Piece& line) { return line.first_sweep == line.last_sweep; });
  LineMap map;
  map.corners = corners_of(lines, options);
  for (const Piece& line : lines) {
    map.lines.push_back({line.from, line.to, line.deviation, static_cast<std::uint32_t>(line.moments.count)});
  }
  return map;
}

}  // namespace pingvox::bench
