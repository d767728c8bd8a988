#include "lidar_scans.hpp"

#include <cmath>
#include <numbers>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/sim/scene.hpp"

namespace pingvox::bench {
namespace {

constexpr double kRange_m = 50.0, kWay_m = 0.5;

RayCloud scan_at(const World& world, const Pose& map_from_sensor, const LidarOptions& options) {
  RayCloud scan{map_from_sensor.translation().cast<float>(), {}};
  const Eigen::Vector3d origin_m = scan.origin_m.cast<double>();
  for (std::size_t step = 0; step < options.steps; ++step) {
    const double bearing = 2.0 * std::numbers::pi * static_cast<double>(step) / static_cast<double>(options.steps);
    for (std::size_t ring = 0; ring < options.rings; ++ring) {
      const double up = static_cast<double>(ring) / static_cast<double>(options.rings - 1) - 0.5;
      const double elevation = up * options.height_deg * kDegree_rad;
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(bearing), std::cos(elevation) * std::sin(bearing),
                                      std::sin(elevation));
      const SoundRay ray{origin_m, map_from_sensor.linear() * direction};
      if (const auto met = world.first(ray, kRange_m)) {
        scan.ends_m.emplace_back((origin_m + met->range_m * ray.direction).cast<float>());
      }
    }
  }
  return scan;
}

}  // namespace

std::vector<RayCloud> lidar_scans(const LidarOptions& options) {
  const Scene scene = harbour_scene({.length_m = 60.0, .width_m = 40.0, .water_above_m = 10.0, .water_below_m = 2.0});
  const double way_m = kWay_m * static_cast<double>(options.scans);
  const TravelOptions travel;
  const Trajectory trajectory = follow_route(scene.loop, way_m / travel.speed_m_s, travel);
  std::vector<RayCloud> scans;
  for (std::size_t i = 0; i < options.scans; ++i) {
    const double time_s = trajectory.poses().front().time_s + static_cast<double>(i) * kWay_m / travel.speed_m_s;
    if (const auto pose = trajectory.at(time_s)) scans.push_back(scan_at(scene.world, *pose, options));
  }
  return scans;
}

}  // namespace pingvox::bench
