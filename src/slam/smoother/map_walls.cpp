#include "slam/smoother/map_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "slam/smoother/echo_pairs.hpp"

namespace pingvox {
namespace {

/// Squares of this size, or of a cell where that is larger: what is looked for near a column is some cells away.
constexpr double kSquare_m = 0.5;
/// What is farther away from the origin is counted to the squares at the border.
constexpr double kMaxSquares = 1 << 30;
/// Columns of a line are within so many cells, and the first of these at least; where they form none, as in walls that
/// are thick, within the second.
constexpr double kLineCells = 3.0;
constexpr std::array<double, 2> kLines_m = {0.25, 0.5};
/// An outline is seen from where the cosine of the angle between its normal and the way to the sonar is more.
constexpr double kSeen = 0.2;

std::uint64_t square_key(std::int32_t x, std::int32_t y) {
  return std::uint64_t{static_cast<std::uint32_t>(x)} << 32U | static_cast<std::uint32_t>(y);
}

}  // namespace

std::int32_t MapWalls::Columns::square_at(double m) const {
  return static_cast<std::int32_t>(std::clamp(std::floor(m / square_m_), -kMaxSquares, kMaxSquares));
}

void MapWalls::Columns::add(const Eigen::Vector2d& place_m) {
  const auto index = static_cast<std::uint32_t>(places_m.size());
  squares_[square_key(square_at(place_m.x()), square_at(place_m.y()))].push_back(index);
  places_m.push_back(place_m);
}

template <class Visit>
void MapWalls::Columns::visit_near(const Eigen::Vector2d& point_m, double reach_m, Visit visit) const {
  const Eigen::Vector2d low = point_m.array() - reach_m, high = point_m.array() + reach_m;
  for (std::int32_t x = square_at(low.x()); x <= square_at(high.x()); ++x) {
    for (std::int32_t y = square_at(low.y()); y <= square_at(high.y()); ++y) {
      const auto square = squares_.find(square_key(x, y));
      if (square == squares_.end()) continue;
      for (const std::uint32_t i : square->second) {
        if ((places_m[i] - point_m).squaredNorm() <= reach_m * reach_m) visit(i);
      }
    }
  }
}

MapWalls::MapWalls(const DistanceField& field)
    : cell_m_(field.cell_m()), all_(std::max(kSquare_m, cell_m_)), outlines_(std::max(kSquare_m, cell_m_)) {
  const auto is_occupied = [&](const Eigen::Vector2d& place_m) {
    return field.classify(place_m) == Occupancy::kOccupied;
  };
  for (const Eigen::Vector2d& column : field.occupied()) {
    all_.add(column);
    const std::array<Eigen::Vector2d, 4> beside = {{{cell_m_, 0.0}, {-cell_m_, 0.0}, {0.0, cell_m_}, {0.0, -cell_m_}}};
    if (!std::ranges::all_of(beside, [&](const Eigen::Vector2d& by_m) { return is_occupied(column + by_m); })) {
      outlines_.add(column);
    }
  }
  std::vector<Eigen::Vector2d> around;
  const auto mean_near = [&around](const Columns& columns, const Eigen::Vector2d& place_m, double reach_m) {
    around.clear();
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    columns.visit_near(place_m, reach_m, [&](std::uint32_t i) {
      around.push_back(columns.places_m[i]);
      sum += columns.places_m[i];
    });
    return Eigen::Vector2d(sum / static_cast<double>(around.size()));
  };
  const double least_m = kLineCells * cell_m_;
  for (const Eigen::Vector2d& column : all_.places_m) {
    Line line;
    for (const double reach_m : kLines_m) {
      line.place_m = mean_near(all_, column, std::max(least_m, reach_m));
      line.normal = normal_of(around);
      if (!line.normal.isZero(0.0)) break;
    }
    all_.lines.push_back(line);
  }
  for (const Eigen::Vector2d& column : outlines_.places_m) {
    // Away from what is occupied around: also of a pile, whose outline is no line.
    const Eigen::Vector2d outwards = column - mean_near(all_, column, std::max(least_m, kLines_m.front()));
    outlines_.lines.push_back({mean_near(outlines_, column, least_m), outwards.normalized()});
  }
}

std::optional<MapWalls::Line> MapWalls::nearest(const Eigen::Vector2d& point_m, const Eigen::Vector2d& ray,
                                                double reach_m) const {
  if (!point_m.allFinite()) return std::nullopt;
  const auto nearest_of = [&](const Columns& columns, const auto& counts) {
    std::optional<std::uint32_t> best;
    double best_square = reach_m * reach_m;
    columns.visit_near(point_m, reach_m, [&](std::uint32_t i) {
      const double square = (columns.places_m[i] - point_m).squaredNorm();
      if (square > best_square || (square == best_square && best) || !counts(columns.lines[i])) return;
      best = i;
      best_square = square;
    });
    return best;
  };
  const auto best = nearest_of(all_, [](const Line&) { return true; });
  if (!best) return std::nullopt;
  if (!all_.lines[*best].normal.isZero(0.0)) return all_.lines[*best];
  const auto seen = nearest_of(outlines_, [&](const Line& line) { return line.normal.dot(ray) < -kSeen; });
  if (!seen) return std::nullopt;
  return outlines_.lines[*seen];
}

}  // namespace pingvox
