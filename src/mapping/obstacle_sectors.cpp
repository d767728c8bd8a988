#include "pingvox/mapping/obstacle_sectors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "pingvox/map/cast_ray.hpp"
#include "pingvox/map/for_each_leaf.hpp"
#include "pingvox/option_errors.hpp"

namespace pingvox {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kSector_rad = kTurn_rad / static_cast<double>(ObstacleSectors::kSectors);

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
  for_each_leaf(map, near, [&](const Leaf& leaf) {
    if (classify(leaf.belief, thresholds) != Occupancy::kOccupied) return;
    const Eigen::Vector2d to_leaf = (leaf.centre_m() - here).head<2>();
    const double range_m = to_leaf.norm();
    if (range_m < options.min_range_m || range_m > options.max_range_m) return;
    // The circle around the leaf's square.
    const double radius_m = leaf.edge_m() * std::numbers::sqrt2 / 2.0;
    const double half_rad = std::asin(std::min(1.0, radius_m / range_m));
    const double clockwise_rad = yaw_rad - std::atan2(to_leaf.y(), to_leaf.x());
    const auto from = static_cast<int>(std::lround((clockwise_rad - half_rad) / kSector_rad));
    const auto to = static_cast<int>(std::lround((clockwise_rad + half_rad) / kSector_rad));
    constexpr int kCount = static_cast<int>(ObstacleSectors::kSectors);
    for (int i = from; i <= to; ++i) {
      Sector& sector = found.sectors[static_cast<std::size_t>((i % kCount + kCount) % kCount)];
      const bool is_nearer = sector.what != What::kObstacle || range_m < sector.range_m;
      if (is_nearer) sector = {What::kObstacle, range_m};
    }
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
