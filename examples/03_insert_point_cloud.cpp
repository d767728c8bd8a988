// Inserts a point cloud into a map, as OctoMap's insertPointCloud does. The cloud here is a wall 2 m ahead.
#include <Eigen/Core>
#include <cstdint>
#include <cstdio>
#include <pingvox/cloud/insert_points.hpp>
#include <vector>

using namespace pingvox;

int main() {
  std::vector<Eigen::Vector3f> points_m;
  for (int y = -20; y <= 20; ++y) {
    for (int z = -10; z <= 10; ++z)
      points_m.emplace_back(2.0F, 0.05F * static_cast<float>(y), 0.05F * static_cast<float>(z));
  }

  OccupancyMap map({.resolution_m = 0.1});
  const Eigen::Vector3d sensor_m(0.0, 0.0, 0.0);
  const auto inserted = insert_points(map, sensor_m, points_m);
  if (!inserted) {
    std::fprintf(stderr, "%s\n", inserted.error().message.c_str());
    return 1;
  }
  std::printf("%ju cells free, %ju occupied\n", std::uintmax_t{inserted->applied.cells_freed},
              std::uintmax_t{inserted->applied.cells_hit});

  const bool wall = map.classify(Eigen::Vector3d(2.05, 0.0, 0.0)) == Occupancy::kOccupied;
  const bool way_to_it = map.classify(Eigen::Vector3d(1.0, 0.0, 0.0)) == Occupancy::kFree;
  return wall && way_to_it ? 0 : 1;
}
