#include "pingvox/analysis/surface_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pingvox {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

TriangleMesh triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return {{a, b, c}, {{0, 1, 2}}};
}

TEST(SurfaceMap, IsOccupiedWhereATriangleIsAndUnknownElsewhere) {
  const MapOptions options{.resolution_m = 1.0};
  const auto map = surface_map(triangle({0.1, 0.1, 0.5}, {1.5, 0.1, 0.5}, {0.1, 1.5, 0.5}), options);
  ASSERT_TRUE(map) << map.error().message;
  const MapCounts counts = map->counts();
  EXPECT_EQ(counts.occupied_cells, 3U);
  EXPECT_EQ(counts.free_cells, 0U);
  for (const Vector3d& point : {Vector3d(0.5, 0.5, 0.5), Vector3d(1.5, 0.5, 0.5), Vector3d(0.5, 1.5, 0.5)}) {
    EXPECT_EQ(map->at(point), options.clamp.highest) << point.transpose();
  }
}

TEST(SurfaceMap, JoinsACubeThatSurfacesFill) {
  // Two layers of cells in a cube of two.
  TriangleMesh mesh;
  for (const double z : {0.5, 1.5}) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    for (const auto& [x, y] : {std::pair{0.1, 0.1}, {1.9, 0.1}, {1.9, 1.9}, {0.1, 1.9}}) {
      mesh.vertices_m.emplace_back(x, y, z);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  const auto map = surface_map(mesh, {.resolution_m = 1.0});
  ASSERT_TRUE(map);
  EXPECT_EQ(map->counts().leaves, 1U);
  EXPECT_EQ(map->counts().occupied_cells, 8U);
}

TEST(SurfaceMap, IsRefusedWhenItIsOutOfProportion) {
  const auto complaint = [](const TriangleMesh& mesh, const MapOptions& options) {
    const auto map = surface_map(mesh, options);
    return map ? "" : map.error().message;
  };
  EXPECT_THAT(complaint(triangle({0, 0, 0}, {3000, 0, 0}, {0, 3000, 0}), {.resolution_m = 0.1}),
              HasSubstr("are its lengths metres?"));
  EXPECT_THAT(complaint(triangle({0, 0, 0}, {1, 0, 0}, {0, 4000, 0}), {.resolution_m = 0.1}),
              HasSubstr("outside of a map of 16 levels"));
  EXPECT_THAT(complaint(triangle({0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}), {.resolution_m = 0.1, .depth = 128}),
              HasSubstr("outside"));
  EXPECT_THAT(complaint(triangle({1e25, 0, 0}, {1e25, 0, 0}, {1e25, 0, 0}), {.resolution_m = 0.1, .depth = 128}),
              HasSubstr("outside"));
  EXPECT_THAT(complaint(triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), {.resolution_m = -0.1}), HasSubstr("resolution"));
}

TEST(SurfaceMap, WorksInLatticesOfOneLevelAndOfAll) {
  for (const int depth : {1, 2, 64, 128}) {
    const auto map =
        surface_map(triangle({0.1, 0.1, 0.1}, {0.9, 0.1, 0.1}, {0.1, 0.9, 0.1}), {.resolution_m = 1.0, .depth = depth});
    ASSERT_TRUE(map) << depth;
    EXPECT_EQ(map->counts().occupied_cells, 1U) << depth;
  }
}

}  // namespace
}  // namespace pingvox
