#include "geometry/internal/triangle_cells.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <set>
#include <tuple>

namespace pingvox {
namespace {

using Eigen::Vector3d;
using Cells = std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>>;

const CellRange kEverywhere{Cell::Constant(-1000), Cell::Constant(1000)};

Cells cells_of(const Triangle& triangle, double cell_m, const CellRange& range = kEverywhere) {
  Cells cells;
  for_each_cell_of(triangle, cell_m, range, [&](const Cell& c) {
    EXPECT_TRUE(cells.emplace(c.x(), c.y(), c.z()).second) << "once each: " << c.transpose();
  });
  return cells;
}

TEST(TriangleCells, OfAFlatTriangleAreThoseAboveIt) {
  // In the face z = 0, over a right angle of two cells.
  EXPECT_EQ(cells_of({Vector3d(0.1, 0.1, 0.0), Vector3d(1.5, 0.1, 0.0), Vector3d(0.1, 1.5, 0.0)}, 1.0),
            (Cells{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(TriangleCells, OfAPointAreOne) {
  const Vector3d point(-0.3, 0.1, 7.25);
  EXPECT_EQ(cells_of({point, point, point}, 0.5), (Cells{{-1, 0, 14}}));
}

TEST(TriangleCells, StayWithinTheRange) {
  EXPECT_EQ(
      cells_of({Vector3d(-5, -5, 0.5), Vector3d(5, -5, 0.5), Vector3d(0, 5, 0.5)}, 1.0, {Cell(0, 0, 0), Cell(1, 0, 3)}),
      (Cells{{0, 0, 0}, {1, 0, 0}}));
}

TEST(TriangleCells, HoldEveryPointOfTheTriangleAndNothingFarFromIt) {
  std::size_t points = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    const auto corner = [&] { return Vector3d(share() * 4 - 2, share() * 4 - 2, share() * 4 - 2); };
    const Triangle t = {corner(), corner(), corner()};
    constexpr double kCell_m = 0.17;
    const Cells cells = cells_of(t, kCell_m);
    for (int i = 0; i < 300; ++i) {
      double u = share(), v = share();
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      const Vector3d point = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
      const Cell c = (point / kCell_m).array().floor().cast<std::int64_t>();
      ASSERT_TRUE(cells.contains({c.x(), c.y(), c.z()})) << point.transpose();
      ++points;
    }
    const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    for (const auto& [x, y, z] : cells) {
      const Vector3d centre =
          (Vector3d(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)) + Vector3d::Constant(0.5)) *
          kCell_m;
      // Half a diagonal at most from the plane.
      ASSERT_LE(std::abs((centre - t[0]).dot(normal)), 0.5 * kCell_m * normal.cwiseAbs().sum() + 1e-9);
    }
  }
  EXPECT_EQ(points, 30'000U);
}

}  // namespace
}  // namespace pingvox
