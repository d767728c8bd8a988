#include "pingvox/sim/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "pingvox/geometry/random.hpp"

namespace pingvox {
namespace {

using Eigen::Vector3d;

constexpr double kFar_m = 1000.0;

double share(std::mt19937_64& random) {
  return static_cast<double>(random() % 1'000'001) / 1e6;
}

/// Each coordinate in -reach..reach.
Vector3d point(std::mt19937_64& random, double reach) {
  const double x = share(random);
  const double y = share(random);
  const double z = share(random);
  return reach * (2.0 * Vector3d(x, y, z) - Vector3d::Ones());
}

Pose some_pose(std::mt19937_64& random) {
  const Vector3d turn = point(random, std::numbers::pi);
  return pose_from_rpy(point(random, 3.0), turn.x(), turn.y(), turn.z());
}

SoundRay some_ray(std::mt19937_64& random) {
  const Vector3d from = point(random, 10.0);
  return {from, (point(random, 2.0) - from).normalized()};
}

/// How far outside of a shape a point is; negative inside.
using Depth = std::function<double(const Vector3d&)>;

/// Crossings of a closed shape lie on it, alternate between in and out, and between them nothing was missed.
void expect_crossings_of(const World& world, const Depth& depth, std::mt19937_64& random, std::size_t& crossings) {
  const SoundRay ray = some_ray(random);
  const std::vector<Crossing> all = world.all(ray, kFar_m);
  ASSERT_LE(all.size(), 2U);
  const auto first = world.first(ray, kFar_m);
  ASSERT_EQ(first.has_value(), !all.empty());
  bool is_inside = depth(ray.origin_m) < 0.0;
  double from = 0.0;
  for (const Crossing& crossing : all) {
    EXPECT_NEAR(depth(ray.at(crossing.range_m)), 0.0, 1e-9);
    EXPECT_NEAR(crossing.normal.norm(), 1.0, 1e-12);
    EXPECT_LE(crossing.normal.dot(ray.direction), 0.0);
    EXPECT_EQ(depth(ray.at(0.5 * (from + crossing.range_m))) < 0.0, is_inside);
    // The normal is that of the surface: the way along it is the way out or in.
    const Vector3d on = ray.at(crossing.range_m);
    EXPECT_GT(std::abs(depth(on + 1e-6 * crossing.normal) - depth(on - 1e-6 * crossing.normal)), 1e-7);
    const auto slope = [&](const Vector3d& way) { return depth(on + 1e-6 * way) - depth(on - 1e-6 * way); };
    const Vector3d steepest = Vector3d(slope(Vector3d::UnitX()), slope(Vector3d::UnitY()), slope(Vector3d::UnitZ()));
    EXPECT_NEAR(std::abs(steepest.normalized().dot(crossing.normal)), 1.0, 1e-3);
    from = crossing.range_m;
    is_inside = !is_inside;
    ++crossings;
  }
  EXPECT_FALSE(is_inside) << "a ray ends outside";
  if (first) {
    EXPECT_EQ(first->range_m, all.front().range_m);
    EXPECT_FALSE(world.first(ray, first->range_m * (1.0 - 1e-9))) << "a limit is a limit";
  }
}

TEST(World, CrossesSpheresWhereTheirEquationHolds) {
  std::size_t crossings = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Sphere sphere{point(random, 3.0), 0.2 + 2.0 * share(random)};
    World world;
    world.add(sphere);
    expect_crossings_of(
        world, [&](const Vector3d& p) { return (p - sphere.centre_m).norm() - sphere.radius_m; }, random, crossings);
  }
  EXPECT_GT(crossings, 500U);
}

TEST(World, CrossesBoxesWhereTheirFacesAre) {
  std::size_t crossings = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Cuboid cuboid{some_pose(random), Vector3d::Constant(0.2) + point(random, 1.0).cwiseAbs()};
    World world;
    world.add(cuboid);
    expect_crossings_of(
        world,
        [&](const Vector3d& p) {
          return ((cuboid.map_from_cuboid.inverse() * p).cwiseAbs() - cuboid.half_m).maxCoeff();
        },
        random, crossings);
  }
  EXPECT_GT(crossings, 300U);
}

TEST(World, CrossesCylindersAndEllipsoidsWhereTheirEquationsHold) {
  std::size_t crossings = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Cylinder cylinder{point(random, 2.0), point(random, 3.0) + Vector3d(0.0, 0.0, 4.0), 0.2 + share(random)};
    World world;
    world.add(cylinder);
    expect_crossings_of(
        world,
        [&](const Vector3d& p) {
          const Vector3d up = cylinder.axis_m.normalized();
          const double level = (p - cylinder.base_m).dot(up);
          const double off = (p - cylinder.base_m - level * up).norm();
          return std::max({off - cylinder.radius_m, -level, level - cylinder.axis_m.norm()});
        },
        random, crossings);
    const Ellipsoid ellipsoid{some_pose(random), Vector3d::Constant(0.2) + point(random, 1.5).cwiseAbs()};
    World other;
    other.add(ellipsoid);
    expect_crossings_of(
        other,
        [&](const Vector3d& p) {
          return (ellipsoid.map_from_ellipsoid.inverse() * p).cwiseQuotient(ellipsoid.radii_m).norm() - 1.0;
        },
        random, crossings);
  }
  EXPECT_GT(crossings, 800U);
}

TEST(World, CrossesAWallAtItsDistanceOverTheCosine) {
  World world;
  world.add(Rectangle{{3.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, {0.0, 0.0, 1.0}});
  for (const double angle : {-0.5, 0.0, 0.3, 0.58}) {
    const SoundRay ray{{0.0, 0.0, 0.0}, {std::cos(angle), std::sin(angle), 0.0}};
    const auto hit = world.first(ray, kFar_m);
    ASSERT_TRUE(hit) << angle;
    EXPECT_NEAR(hit->range_m, 3.0 / std::cos(angle), 1e-12);
    EXPECT_TRUE(hit->normal.isApprox(-Vector3d::UnitX()));
  }
  EXPECT_FALSE(world.first({{0.0, 0.0, 0.0}, {std::cos(0.6), std::sin(0.6), 0.0}}, kFar_m)) << "past its edge";
  EXPECT_FALSE(world.first({{0.0, 0.0, 0.0}, -Vector3d::UnitX()}, kFar_m)) << "behind";
  EXPECT_FALSE(world.first({{0.0, 0.0, 0.0}, Vector3d::UnitY()}, kFar_m)) << "alongside";
  EXPECT_FALSE(world.first({{3.0, 0.0, 0.0}, Vector3d::UnitX()}, kFar_m)) << "a ray that starts on it";
}

TEST(World, WhatIsNearIsAllThatRaysMayCross) {
  World world;
  Random random(5);
  for (int n = 0; n < 60; ++n) {
    const double x = 40.0 * random.uniform() - 20.0;
    const double y = 40.0 * random.uniform() - 20.0;
    world.add(Sphere{{x, y, 0.0}, 1.0});
  }
  const World part = world.near({2.0, -1.0, 0.0}, 8.0);
  EXPECT_LT(part.size(), world.size() / 2);
  std::size_t crossed = 0;
  for (int n = 0; n < 360; ++n) {
    const double bearing = n * std::numbers::pi / 180.0;
    const SoundRay ray{{2.0, -1.0, 0.0}, {std::cos(bearing), std::sin(bearing), 0.0}};
    const auto all = world.first(ray, 8.0), near = part.first(ray, 8.0);
    ASSERT_EQ(all.has_value(), near.has_value());
    if (!all) continue;
    EXPECT_EQ(all->range_m, near->range_m);
    ++crossed;
  }
  EXPECT_GT(crossed, 100U);
}

TEST(World, ItsMeshIsCrossedWhereItIs) {
  // The shapes' own triangles in the tree of boxes, against their closed forms and against all triangles in a row.
  std::size_t both = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    World world;
    world.add(Cuboid{some_pose(random), {1.0, 0.5, 0.7}});
    world.add(Sphere{point(random, 3.0), 1.0});
    world.add(Cylinder{point(random, 2.0), {0.5, 0.5, 2.0}, 0.5});
    world.add(Ellipsoid{some_pose(random), {1.0, 0.4, 0.6}});
    const double tolerance_m = 0.001;
    const TriangleMesh mesh = world.mesh(tolerance_m);
    World as_mesh;
    as_mesh.add(mesh);
    EXPECT_TRUE(world.bounds().contains(as_mesh.bounds().min() + Vector3d::Constant(1e-6)));
    for (int n = 0; n < 200; ++n) {
      const SoundRay ray = some_ray(random);
      const auto expected = world.first(ray, kFar_m);
      const auto got = as_mesh.first(ray, kFar_m);
      // Only where it grazes may a surface by pieces be missed.
      if (!expected || !got) continue;
      const double cosine = -expected->normal.dot(ray.direction);
      if (cosine < 0.2) continue;
      EXPECT_NEAR(got->range_m, expected->range_m, 2.0 * tolerance_m / cosine);
      ++both;
    }
  }
  EXPECT_GT(both, 1500U);
}

TEST(TriangleTree, FindsWhatLookingAtEachTriangleFinds) {
  std::size_t crossings = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    TriangleMesh mesh;
    for (std::uint32_t n = 0; n < 300; ++n) {
      const Vector3d at = point(random, 3.0);
      for (int corner = 0; corner < 3; ++corner) mesh.vertices_m.emplace_back(at + point(random, 1.0));
      mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
    }
    World all;
    all.add(mesh);
    std::vector<World> each;
    for (const auto& triangle : mesh.triangles) {
      each.emplace_back();
      each.back().add(TriangleMesh{mesh.vertices_m, {triangle}});
    }
    for (int n = 0; n < 20; ++n) {
      const SoundRay ray = some_ray(random);
      std::vector<double> expected;
      for (const World& one : each) {
        if (const auto hit = one.first(ray, 8.0)) expected.push_back(hit->range_m);
      }
      std::sort(expected.begin(), expected.end());
      const auto got = all.all(ray, 8.0);
      ASSERT_EQ(got.size(), expected.size());
      for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(got[i].range_m, expected[i]);
      if (!expected.empty()) {
        EXPECT_EQ(all.first(ray, 8.0)->range_m, expected.front());
      }
      crossings += expected.size();
    }
  }
  EXPECT_GT(crossings, 300U);
}

// Kills triangles that end a little before their edges: rays slip through between two of them.
TEST(Heightfield, HasNoGapsAlongItsEdges) {
  World world;
  world.add(heightfield(std::vector<double>(16, 0.0), 4, Vector3d::Zero(), 1.0));
  std::mt19937_64 random(4);
  for (int n = 0; n < 3000; ++n) {
    const double along = 0.01 + 0.98 * share(random), beside = 2e-5 * (share(random) - 0.5);
    // The diagonal of a square, and its sides.
    for (const auto& [x, y] :
         {std::pair{1.0 + along + beside, 2.0 - along}, {1.0 + beside, 1.0 + along}, {1.0 + along, 1.0 + beside}}) {
      ASSERT_TRUE(world.first({Vector3d(x, y, 5.0), -Vector3d::UnitZ()}, 10.0)) << x << ", " << y;
    }
  }
}

TEST(Heightfield, IsCrossedAtItsHeights) {
  const std::size_t columns = 5;
  std::vector<double> heights;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 5; ++column) heights.push_back(0.1 * column + 0.2 * row);
  }
  World world;
  world.add(heightfield(heights, columns, {-1.0, -1.0, -3.0}, 0.5));
  for (const double x : {-0.9, 0.13, 0.8}) {
    for (const double y : {-0.8, 0.1, 0.4}) {
      const auto hit = world.first({{x, y, 5.0}, -Vector3d::UnitZ()}, kFar_m);
      ASSERT_TRUE(hit) << x << ' ' << y;
      EXPECT_NEAR(5.0 - hit->range_m, -3.0 + 0.1 * (x + 1.0) / 0.5 + 0.2 * (y + 1.0) / 0.5, 1e-9) << "a plane";
    }
  }
  EXPECT_FALSE(world.first({{1.1, 0.0, 5.0}, -Vector3d::UnitZ()}, kFar_m)) << "beside it";
}

}  // namespace
}  // namespace pingvox
