#include "pingvox/cloud/trace_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <span>
#include <tuple>
#include <vector>

#include "pingvox/map/occupancy_map.hpp"
#include "support/differences.hpp"
#include "support/uniform.hpp"

using namespace pingvox;

namespace {

using test::uniform;

struct Case {
  Lattice lattice{0.1};
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3f> points_m;
  PointScanOptions options;
};

/// Few points and many, in clumps that share cells; some are no numbers, and in small lattices some lie outside. Now
/// and then one is so far away that no window is made for all of them.
Case random_case(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Case one{.lattice = Lattice(0.1, seed % 3 == 0 ? 6 : 16), .points_m = {}, .options = {}};
  one.origin_m = {uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0)};
  const auto clumps = seed % 4 == 0 ? 2 : 200;
  for (int clump = 0; clump < clumps; ++clump) {
    const Eigen::Vector3d middle_m(uniform(random, -4.0, 4.0), uniform(random, -4.0, 4.0), uniform(random, -4.0, 4.0));
    for (auto n = random() % 12; n > 0; --n) {
      const Eigen::Vector3d beside_m(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1),
                                     uniform(random, -0.1, 0.1));
      one.points_m.emplace_back((middle_m + beside_m).cast<float>());
    }
  }
  one.points_m.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  if (seed % 7 == 1) one.points_m.emplace_back(1e30F, 0.0F, 0.0F);
  if (seed % 2 == 0) one.options.max_range_m = 2.5;
  if (seed % 5 == 0) one.options.ray = RayAlgorithm::kBresenham;
  return one;
}

struct Traced {
  std::vector<test::Node> nodes;
  std::size_t outside = 0;
};

Traced apply_scan(const Case& one, const ScanUpdate& scan, std::size_t outside) {
  OccupancyMap map({.resolution_m = one.lattice.resolution_m(), .depth = one.lattice.depth()});
  EXPECT_TRUE(map.apply(scan));
  return {test::nodes_of(map), outside};
}

template <class Point>
Traced trace_case(const Case& one, const std::vector<Point>& points_m) {
  ScanUpdate scan(one.lattice);
  const std::size_t outside = PointTracer(one.options).trace(one.origin_m, std::span<const Point>(points_m), scan);
  return apply_scan(one, scan, outside);
}

/// One ray after the other. REQUIRES that all points lie in the lattice
ScanUpdate trace_rays_singly(const Case& one) {
  ScanUpdate singly(one.lattice);
  for (const Eigen::Vector3f& point_m : one.points_m) {
    const Eigen::Vector3d end_m = point_m.cast<double>(), way_m = end_m - one.origin_m;
    const double part = std::min(1.0, one.options.max_range_m / way_m.norm());
    if (part == 1.0) singly.add_hit(*one.lattice.key_of<WideWord>(end_m), one.options.hit);
    const Eigen::Vector3d cut_m = part == 1.0 ? end_m : Eigen::Vector3d(one.origin_m + way_m * part);
    EXPECT_TRUE(trace_ray(one.origin_m, cut_m, one.options.ray, singly));
  }
  return singly;
}

std::vector<Eigen::Vector3d> as_doubles(const std::vector<Eigen::Vector3f>& points_m) {
  std::vector<Eigen::Vector3d> same_m;
  for (const Eigen::Vector3f& point_m : points_m) same_m.push_back(point_m.cast<double>());
  return same_m;
}

// Kills a path on which points in single precision are traced as others are: to cells, cut at a range, one by one.
TEST(TracePoints, SinglePrecisionMakesTheSameMap) {
  std::size_t nodes = 0, outside = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Case one = random_case(seed);
    for (const EndPoints ends : {EndPoints::kExact, EndPoints::kCells}) {
      one.options.ends = ends;
      const Traced found = trace_case(one, one.points_m), expected = trace_case(one, as_doubles(one.points_m));
      ASSERT_EQ(found.outside, expected.outside);
      ASSERT_EQ(test::first_difference(found.nodes, expected.nodes), "");
      nodes += found.nodes.size();
      outside += found.outside;
    }
  }
  EXPECT_GT(nodes, 100'000U);
  EXPECT_GT(outside, 200U);
}

// Kills rays of a scan in one layer of cells that are marked beside their place in the map, left out where others leave
// it or are cut, or still there in the next scan.
TEST(TracePoints, FlatSweepsMarkWhatTheirRaysMark) {
  ScanUpdate coarse(Lattice(0.1)), fine(Lattice(0.01));
  std::size_t nodes = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    // Windows of 8 bits, and of 11.
    ScanUpdate& together = seed % 30 == 15 ? fine : coarse;
    Case one{.lattice = together.lattice(), .points_m = {}, .options = {}};
    one.origin_m = {uniform(random, -2.0, 2.0), uniform(random, -2.0, 2.0), uniform(random, -2.0, 2.0)};
    if (seed % 2 == 0) one.options.max_range_m = 3.0;
    const int rays = seed % 5 == 0 ? 2500 : 200;  // in one block and in several
    for (int ray = 0; ray < rays; ++ray) {
      const double bearing = uniform(random, -3.0, 3.0), range_m = uniform(random, 0.5, 6.0);
      Eigen::Vector3d end_m = one.origin_m + range_m * Eigen::Vector3d(std::cos(bearing), std::sin(bearing), 0.0);
      if (seed % 3 == 0 && ray >= rays - 10) end_m.z() += uniform(random, -3.0, 3.0);
      one.points_m.emplace_back(end_m.cast<float>());
    }
    const ScanUpdate singly = trace_rays_singly(one);
    PointTracer tracer(one.options);
    ASSERT_EQ(tracer.trace(one.origin_m, std::span<const Eigen::Vector3f>(one.points_m), together), 0U);
    const Traced expected = apply_scan(one, singly, 0), found = apply_scan(one, together, 0);
    ASSERT_EQ(found.nodes, expected.nodes);
    nodes += found.nodes.size();
    together.clear();
    ASSERT_EQ(tracer.trace(one.origin_m, std::span<const Eigen::Vector3f>(one.points_m), together), 0U);
    ASSERT_EQ(apply_scan(one, together, 0).nodes, expected.nodes) << "the second time";
    together.clear();
  }
  EXPECT_GT(nodes, 50'000U);
}

// Kills rays that are farther than the points that the size of a window is guessed from, and are marked beside their
// place: in and around each cell of the window's borders.
TEST(TracePoints, RaysBeyondTheWindowAreMarkedWhereTheyAre) {
  Case one{.points_m = {}, .options = {}};
  one.origin_m.setConstant(0.05);
  for (int pair = 0; pair < 1200; ++pair) {
    one.points_m.emplace_back(3.0F, 0.05F, 0.05F);  // every second one is looked at
    Eigen::Vector3d end_m = one.origin_m;
    end_m[pair % 3] += (pair % 2 == 0 ? 0.1 : -0.1) * (pair / 6);
    one.points_m.push_back(end_m.cast<float>());
  }
  ScanUpdate together(one.lattice);
  ASSERT_EQ(PointTracer(one.options).trace(one.origin_m, std::span<const Eigen::Vector3f>(one.points_m), together), 0U);
  EXPECT_EQ(apply_scan(one, together, 0).nodes, apply_scan(one, trace_rays_singly(one), 0).nodes);
}

// Kills cells that one scan marked and that are still marked in the next one, which is another.
TEST(TracePoints, ScansOfOneTracerAreIndependent) {
  PointTracer tracer;
  std::size_t nodes = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Case one = random_case(seed);
    one.options = {};
    ScanUpdate scan(one.lattice);
    const std::size_t outside = tracer.trace(one.origin_m, std::span<const Eigen::Vector3f>(one.points_m), scan);
    const Traced found = apply_scan(one, scan, outside), expected = trace_case(one, one.points_m);
    ASSERT_EQ(found.outside, expected.outside);
    ASSERT_EQ(test::first_difference(found.nodes, expected.nodes), "");
    nodes += found.nodes.size();
  }
  EXPECT_GT(nodes, 20'000U);
}

// Kills a cell whose ray is not walked, one that stays hit although it is too far away, a ray that ends
// beside the middle of its cell.
TEST(TracePoints, CellsGetOneRayEachToTheirMiddles) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Case one = random_case(seed);
    std::map<std::tuple<std::uint16_t, std::uint16_t, std::uint16_t>, Eigen::Vector3d> middles_m;
    std::vector<Eigen::Vector3d> ends_m;
    for (const Eigen::Vector3d& point_m : as_doubles(one.points_m)) {
      if (const auto key = one.lattice.key_of(point_m)) {
        middles_m.emplace(std::tuple(key->x, key->y, key->z), one.lattice.centre_of(*key));
      } else {
        ends_m.push_back(point_m);
      }
    }
    for (const auto& [cell, middle_m] : middles_m) ends_m.push_back(middle_m);
    ScanUpdate scan(one.lattice);
    std::size_t outside = 0;
    for (const Eigen::Vector3d& end_m : ends_m) {
      const double range_m = (end_m - one.origin_m).norm();
      if (range_m > one.options.max_range_m) {
        const Eigen::Vector3d cut_m = one.origin_m + (end_m - one.origin_m) * (one.options.max_range_m / range_m);
        outside += trace_ray(one.origin_m, cut_m, one.options.ray, scan) ? 0 : 1;
        continue;
      }
      if (const auto key = one.lattice.key_of(end_m)) scan.add_hit(*key, one.options.hit);
      outside += trace_ray(one.origin_m, end_m, one.options.ray, scan) ? 0 : 1;
    }
    one.options.ends = EndPoints::kCells;
    const Traced found = trace_case(one, one.points_m), expected = apply_scan(one, scan, outside);
    ASSERT_EQ(found.outside, expected.outside);
    ASSERT_EQ(test::first_difference(found.nodes, expected.nodes), "");
  }
}

// Kills a limit in metres where cells are meant: it has to follow the resolution.
TEST(CheckRays, ARayHasAtMostAMillionCells) {
  constexpr double kMaxCells = 1e6;
  for (const double resolution_m : {0.01, 0.1, 2.5}) {
    SCOPED_TRACE(resolution_m);
    const Lattice lattice(resolution_m, 40);
    const auto is_allowed = [&](double cells, double max_range_m) {
      const std::vector<Eigen::Vector3d> points = {{0.0, cells * resolution_m, 0.0}};
      PointScanOptions options;
      options.max_range_m = max_range_m;
      return check_rays(Eigen::Vector3d::Zero(), std::span(points), options, lattice).has_value();
    };
    const double unlimited = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(is_allowed(0.99 * kMaxCells, unlimited));
    EXPECT_FALSE(is_allowed(1.01 * kMaxCells, unlimited));
    EXPECT_TRUE(is_allowed(1.01 * kMaxCells, 0.5 * kMaxCells * resolution_m)) << "it ends at the greatest range";
  }
}

}  // namespace
