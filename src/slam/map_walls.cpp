#include "slam/map_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "slam/echo_pairs.hpp"

namespace pingvox {
namespace {

constexpr double kSquare_m = 0.5;
/// Columns of a line are within so many cells, and the first of these at least; where they form none, as in walls that
/// are thick, within the second.
constexpr double kLineCells = 3.0;
constexpr std::array<double, 2> kLines_m = {0.25, 0.5};

std::int32_t square_at(double m) {
  return static_cast<std::int32_t>(std::floor(m / kSquare_m));
}

std::uint64_t square_key(std::int32_t x, std::int32_t y) {
  return std::uint64_t{static_cast<std::uint32_t>(x)} << 32U | static_cast<std::uint32_t>(y);
}

}  // namespace

template <class Visit>
void MapWalls::visit_near(const Eigen::Vector2d& point_m, double reach_m, Visit visit) const {
  const Eigen::Vector2d low = point_m.array() - reach_m, high = point_m.array() + reach_m;
  for (std::int32_t x = square_at(low.x()); x <= square_at(high.x()); ++x) {
    for (std::int32_t y = square_at(low.y()); y <= square_at(high.y()); ++y) {
      const auto square = squares_.find(square_key(x, y));
      if (square == squares_.end()) continue;
      for (const std::uint32_t i : square->second) {
        if ((columns_[i] - point_m).squaredNorm() <= reach_m * reach_m) visit(i);
      }
    }
  }
}

MapWalls::MapWalls(const DistanceField& field) : cell_m_(field.cell_m()), columns_(field.occupied()) {
  for (std::uint32_t i = 0; i < columns_.size(); ++i) {
    squares_[square_key(square_at(columns_[i].x()), square_at(columns_[i].y()))].push_back(i);
  }
  std::vector<Eigen::Vector2d> around;
  for (const Eigen::Vector2d& column : columns_) {
    Line line{column, Eigen::Vector2d::Zero()};
    for (const double least_m : kLines_m) {
      around.clear();
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      visit_near(column, std::max(kLineCells * cell_m_, least_m), [&](std::uint32_t i) {
        around.push_back(columns_[i]);
        sum += columns_[i];
      });
      line = {sum / static_cast<double>(around.size()), normal_of(around)};
      if (!line.normal.isZero(0.0)) break;
    }
    lines_.push_back(line);
  }
}

std::optional<MapWalls::Line> MapWalls::nearest(const Eigen::Vector2d& point_m, double reach_m) const {
  std::optional<std::uint32_t> best;
  double best_square = reach_m * reach_m;
  visit_near(point_m, reach_m, [&](std::uint32_t i) {
    const double square = (columns_[i] - point_m).squaredNorm();
    if (square > best_square || (square == best_square && best)) return;
    best = i;
    best_square = square;
  });
  if (!best || lines_[*best].normal.isZero(0.0)) return std::nullopt;
  return lines_[*best];
}

}  // namespace pingvox
