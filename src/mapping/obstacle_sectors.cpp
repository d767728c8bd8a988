#include "mapping/internal/obstacle_sectors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "base/option_errors.hpp"
#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/for_each_leaf.hpp"

namespace pingvox {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kSector_rad = kTurn_rad / static_cast<double>(ObstacleSectors::kSectors);

/// Calls `visit(centre_m)` for the columns of finest cells of a leaf that may be the nearest to a place in a direction:
/// those at its sides, or all where the place is within it.
template <class Visitor>
void for_each_near_column(const Leaf& leaf, double cell_m, const Eigen::Vector2d& here, double reach_m, Visitor visit) {
  const Eigen::Vector2d corner_m = leaf.centre_m().head<2>().array() - 0.5 * leaf.edge_m();
  // Leaves of deep maps have more cells than integers count.
  const auto whole = [](double cells) { return std::lround(std::clamp(cells, -0x1p60, 0x1p60)); };
  const auto last = whole(leaf.edge_m() / cell_m) - 1;
  const Eigen::Array2d inside = (here - corner_m).array();
  const bool is_within = (inside > 0.0).all() && (inside < leaf.edge_m()).all();
  const auto first_near = [&](double from_m) { return std::clamp(whole((from_m - reach_m) / cell_m), 0L, last); };
  const auto last_near = [&](double from_m) { return std::clamp(whole((from_m + reach_m) / cell_m), 0L, last); };
  for (long x = first_near(inside.x()); x <= last_near(inside.x()); ++x) {
    const bool is_side = is_within || x == 0 || x == last;
    for (long y = first_near(inside.y()); y <= last_near(inside.y()); ++y) {
      if (!is_side && y != 0 && y != last) continue;
      visit(corner_m + cell_m * Eigen::Vector2d(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5));
    }
  }
}

}  // namespace

Result<void> ObstacleOptions::validate() const {
  OptionErrors errors;
  errors.require(min_range_m >= 0.0, "min_range_m", "at least 0", min_range_m);
  errors.require(max_range_m > min_range_m && max_range_m <= 650.0, "max_range_m", "above min_range_m and at most 650",
                 max_range_m);
  errors.require(half_height_m > 0.0 && half_height_m <= 100.0, "half_height_m", "above 0 and at most 100",
                 half_height_m);
  return errors.result("obstacles");
}

ObstacleSectors nearest_obstacles(const OccupancyMap& map, const Pose& map_from_body, const ObstacleOptions& options) {
  assert(options.validate());
  using What = ObstacleSectors::What;
  using Sector = ObstacleSectors::Sector;
  ObstacleSectors found;
  const Eigen::Vector3d here = map_from_body.translation();
  const Eigen::Vector3d ahead = map_from_body.linear().col(0);
  const double yaw_rad = std::atan2(ahead.y(), ahead.x());

  const Eigen::Vector3d reach(options.max_range_m, options.max_range_m, options.half_height_m);
  LeafQuery near;
  near.box = Box{here - reach, here + reach};
  const Thresholds& thresholds = map.options().thresholds;
  const double cell_m = map.lattice().resolution_m();
  for_each_leaf(map, near, [&](const Leaf& leaf) {
    if (classify(leaf.belief, thresholds) != Occupancy::kOccupied) return;
    for_each_near_column(leaf, cell_m, here.head<2>(), options.max_range_m, [&](const Eigen::Vector2d& centre_m) {
      const Eigen::Vector2d to_cell = centre_m - here.head<2>();
      const double range_m = to_cell.norm();
      if (range_m < options.min_range_m || range_m > options.max_range_m) return;
      // The circle around the cell's square.
      const double half_rad = std::asin(std::min(1.0, cell_m * std::numbers::sqrt2 / 2.0 / range_m));
      const double clockwise_rad = yaw_rad - std::atan2(to_cell.y(), to_cell.x());
      const auto from = static_cast<int>(std::lround((clockwise_rad - half_rad) / kSector_rad));
      const auto to = static_cast<int>(std::lround((clockwise_rad + half_rad) / kSector_rad));
      constexpr int kCount = static_cast<int>(ObstacleSectors::kSectors);
      for (int i = from; i <= to; ++i) {
        Sector& sector = found.sectors[static_cast<std::size_t>((i % kCount + kCount) % kCount)];
        const bool is_nearer = sector.what != What::kObstacle || range_m < sector.range_m;
        if (is_nearer) sector = {What::kObstacle, range_m};
      }
    });
  });

  for (std::size_t i = 0; i < found.sectors.size(); ++i) {
    Sector& sector = found.sectors[i];
    if (sector.what == What::kObstacle) continue;
    const double bearing_rad = yaw_rad - static_cast<double>(i) * kSector_rad;
    const Eigen::Vector3d direction(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
    // The blanking range around the head stays unknown.
    constexpr double kBlanking_m = 1.0;
    const double blind_m = std::min(std::max(options.min_range_m, kBlanking_m), options.max_range_m / 2.0);
    const RayEnd end =
        cast_ray(map, here + blind_m * direction, direction, options.max_range_m - blind_m, UnknownCells::kBlock);
    if (end.what == Occupancy::kFree) sector.what = What::kClear;
  }
  return found;
}

}  // namespace pingvox
