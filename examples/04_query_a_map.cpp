// Asks a map what is at a point, what a ray meets, and which cells are occupied.
//
//   04_query_a_map tank.bt
#include <cstdio>
#include <pingvox/io/file.hpp>
#include <pingvox/io/maps.hpp>
#include <pingvox/map/cast_ray.hpp>
#include <pingvox/map/for_each_leaf.hpp>

using namespace pingvox;

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "Usage: 04_query_a_map MAP\n");
    return 2;
  }
  const auto file = read_file(argv[1]);
  const auto read = file.and_then([](const FileBytes& bytes) { return read_map(bytes); });
  if (!read) {
    std::fprintf(stderr, "%s\n", read.error().message.c_str());
    return 1;
  }
  const OccupancyMap& map = read->map;

  // A point: what is there, and how sure the map is of it.
  const Eigen::Vector3d point_m(1.0, 0.0, 0.0);
  switch (map.classify(point_m)) {
    case Occupancy::kFree:
      std::printf("1 m ahead: free\n");
      break;
    case Occupancy::kOccupied:
      std::printf("1 m ahead: occupied\n");
      break;
    case Occupancy::kUnknown:
      std::printf("1 m ahead: unknown\n");
      break;
  }
  if (const auto belief = map.at(point_m)) std::printf("occupied with probability %.2f\n", belief->probability());

  // A ray: the first occupied cell to the left.
  const RayEnd end = cast_ray(map, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitY(), 10.0);
  if (end.what == Occupancy::kOccupied) std::printf("to the left: occupied at %.2f m\n", end.range_m);

  // All leaves, or those of a box.
  LeafQuery near;
  near.box = Box{{-2.0, -2.0, -2.0}, {2.0, 2.0, 2.0}};
  std::size_t occupied = 0;
  for_each_leaf(map, near, [&](const Leaf& leaf) {
    if (classify(leaf.belief, map.options().thresholds) == Occupancy::kOccupied) ++occupied;
  });
  std::printf("within 2 m: %zu occupied leaves\n", occupied);
}
