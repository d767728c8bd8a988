#include "cloud/ray_kernels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "geometry/internal/ray_dda.hpp"
#include "support/exact_segment.hpp"
#include "support/kernels.hpp"
#include "support/rounds.hpp"

namespace pingvox::detail {
namespace {

using test::for_each_kernel;
using Cell = std::array<std::int64_t, 3>;

constexpr int kWindowBits = 7;  ///< 128 cells along each axis, from -64 to 63
constexpr std::int64_t kHalf = 64;

/// A window about the origin of the map.
RayGrid grid_around_origin(double cells_per_m = 1.0) {
  RayGrid grid;
  grid.cells_per_m = cells_per_m;
  grid.lowest.fill(-kHalf);
  grid.inside_from.fill(-static_cast<double>(kHalf));
  grid.inside_to.fill(static_cast<double>(kHalf));
  return grid;
}

/// Where a cell of the window stands in it. REQUIRES -64 <= cell <= 63
std::uint64_t place_of(const Cell& cell) {
  std::uint64_t place = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto in_window = static_cast<std::uint64_t>(cell[a] + kHalf);
    for (std::size_t bit = 0; bit < kWindowBits; ++bit) place |= (in_window >> bit & 1) << (3 * bit + a);
  }
  return place;
}

/// The cell that a point, in cells, lies in.
Cell cell_of(const Eigen::Vector3d& point) {
  const auto floor = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
  return {floor(point.x()), floor(point.y()), floor(point.z())};
}

/// The place of a cell that may be outside of the window.
std::uint64_t place_or_none(const RayGrid& grid, const Eigen::Vector3d& at) {
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = at[static_cast<Eigen::Index>(a)];
    if (!(x >= grid.inside_from[a] && x < grid.inside_to[a])) return kNoPlace;
  }
  return place_of(cell_of(at));
}

/// Places that are marked as missed.
std::set<std::uint64_t> missed_cells(ScanWindow& window) {
  std::set<std::uint64_t> missed;
  for (std::uint64_t place = 0; place < std::uint64_t{1} << (3 * kWindowBits); ++place) {
    if ((window.missed()[place / 64] >> (place % 64) & 1) == 0) continue;
    missed.insert(place);
    EXPECT_EQ(window.touched()[place >> ScanWindow::kPageCellBits], 1);
  }
  return missed;
}

/// Ends all around, short and long; many on corners, edges and faces of cells, where ties are to be decided alike.
std::vector<Eigen::Vector3d> ends_around(const Eigen::Vector3d& from_m, std::mt19937_64& random, std::size_t count) {
  std::vector<Eigen::Vector3d> ends;
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d end(40.0 * uniform() - 20.0, 40.0 * uniform() - 20.0, 40.0 * uniform() - 20.0);
    const auto kind = random() % 8;
    if (kind == 0) end = end.array().round();
    if (kind == 1) end = from_m.array() + (end - from_m).array().round();  // at 45 degrees, along axes
    if (kind == 2) end = from_m + 0.01 * end;
    if (kind == 3) end *= 3.0;  // some beyond the window
    if (kind == 4) end[static_cast<Eigen::Index>(random() % 3)] = from_m[static_cast<Eigen::Index>(random() % 3)];
    ends.push_back(end);
  }
  ends.emplace_back(std::nan(""), 0.0, 0.0);
  ends.emplace_back(0.0, std::numeric_limits<double>::infinity(), 0.0);
  ends.emplace_back(0.0, 0.0, -1e300);
  return ends;
}

/// Where a moving head may be: some beyond the window, some in no number.
std::vector<Eigen::Vector3d> beginnings_around(const Eigen::Vector3d& from_m, std::mt19937_64& random,
                                               std::size_t count) {
  std::vector<Eigen::Vector3d> beginnings;
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d begin = from_m + Eigen::Vector3d(uniform(), uniform(), uniform());
    const auto kind = random() % 16;
    if (kind == 0) begin = begin.array().round();
    if (kind == 1) begin *= 1e4;
    if (kind == 2) begin.y() = std::nan("");
    beginnings.push_back(begin);
  }
  return beginnings;
}

template <class Point>
std::vector<Point> as(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Point> same;
  for (const Eigen::Vector3d& point : points) same.push_back(point.cast<typename Point::Scalar>());
  return same;
}

template <class Point>
void expect_places() {
  std::size_t found = 0, outside = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    RayGrid grid = grid_around_origin(seed % 3 == 0 ? 20.0 / 3.0 : 1.3);
    if (seed % 5 == 0) grid.inside_to[1] = 20.0;  // the lattice's border
    const std::vector<Point> points = as<Point>(ends_around({0.3, -0.1, 0.2}, random, random() % 30));
    std::vector<std::uint64_t> expected;
    for (const Point& point : points) {
      expected.push_back(place_or_none(grid, point.template cast<double>() * grid.cells_per_m));
      ++(expected.back() == kNoPlace ? outside : found);
    }
    for_each_kernel([&] {
      std::vector<std::uint64_t> places(3, 7);
      find_places(grid, std::span<const Point>(points), places);
      ASSERT_EQ(places, expected);
    });
  }
  EXPECT_GT(found, 1000U);
  EXPECT_GT(outside, 600U);
}

// Kills axes that are mixed up, points of the last, short vector that are made up, points outside or no numbers that
// get a place, places that are found in single precision.
TEST(RayKernels, PlacesAreThoseOfTheCellsWithPoints) {
  expect_places<Eigen::Vector3d>();
  expect_places<Eigen::Vector3f>();
}

template <class Point>
void expect_marks() {
  std::size_t marked = 0, taken = 0, left_out = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(200); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const double cells_per_m = seed % 3 == 0 ? 1.0 : 1.7;
    Eigen::Vector3d from(0.1 * static_cast<double>(random() % 37), -0.2, 0.05 * static_cast<double>(random() % 100));
    if (seed % 4 == 0) from = Eigen::Vector3d::Zero();
    const RayGrid grid = grid_around_origin(cells_per_m);
    const std::vector<Point> ends = as<Point>(ends_around(from, random, 1 + random() % 100));
    const std::vector<Eigen::Vector3d> beginnings =
        seed % 2 == 0 ? std::vector(ends.size(), from) : beginnings_around(from, random, ends.size());
    for_each_kernel([&] {
      PreparedRays rays;
      prepare_rays(grid, beginnings, std::span<const Point>(ends), rays);
      ASSERT_EQ(rays.count, ends.size());
      std::set<std::uint64_t> expected;
      for (std::size_t i = 0; i < ends.size(); ++i) {
        const Eigen::Vector3d begin = beginnings[i] * cells_per_m, to = ends[i].template cast<double>() * cells_per_m;
        if (rays.end[i] == kNoPlace) {
          ++left_out;
          ASSERT_EQ(rays.left[i], 0);
          continue;
        }
        ++taken;
        ASSERT_EQ(rays.start[i], place_or_none(grid, begin));
        ASSERT_EQ(rays.end[i], place_or_none(grid, to));
        FaceCrossings crossings(begin, to);
        Cell cell = cell_of(begin);
        while (crossings.left() > 0) {
          expected.insert(place_of(cell));
          const std::size_t axis = crossings.next_axis();
          cell[axis] += crossings.is_ahead(axis) ? 1 : -1;
          crossings.cross(axis);
        }
        ASSERT_EQ(cell, cell_of(to));
      }
      ScanWindow window;
      window.open(kWindowBits);
      mark_rays(rays, window);
      ASSERT_EQ(missed_cells(window), expected);
      marked += expected.size();
    });
  }
  EXPECT_GT(marked, test::rounds(100'000));
  EXPECT_GT(taken, test::rounds(4'000));
  EXPECT_GT(left_out, test::rounds(500));
}

// Kills a lane that takes another face than the plain stepper (ties, backward steps, ends on faces), a carry that does
// not reach the next bit of its axis, a ray that marks its end, lanes that go on marking when their ray has ended, rays
// that change places when they are sorted by length, a ray that begins where its neighbour does.
TEST(RayKernels, MarkedCellsAreThoseOfFaceCrossings) {
  expect_marks<Eigen::Vector3d>();
  expect_marks<Eigen::Vector3f>();
}

// Kills a drift that only exact arithmetic sees: cells of which one is not crossed, or not told, by more than 1e-9.
TEST(RayKernels, MarkedCellsAreThoseOfExactArithmetic) {
  using test::ExactSegment;
  std::size_t cells = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(300); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto coordinate = [&] { return static_cast<std::int64_t>(random() >> 17) - kHalf * ExactSegment::kUnit; };
    const auto point = [](const ExactSegment::Point& at) {
      const auto cells_of = [&](std::size_t a) {
        return std::ldexp(static_cast<double>(at[a]), -ExactSegment::kShift);
      };
      return Eigen::Vector3d(cells_of(0), cells_of(1), cells_of(2));
    };
    const ExactSegment::Point from{coordinate(), coordinate(), coordinate()},
        to{coordinate(), coordinate(), coordinate()};
    const ExactSegment segment(from, to);
    const std::array<Eigen::Vector3d, 1> begin{point(from)}, end{point(to)};
    const RayGrid grid = grid_around_origin();
    for_each_kernel([&] {
      PreparedRays rays;
      prepare_rays(grid, begin, std::span<const Eigen::Vector3d>(end), rays);
      if (rays.end[0] == kNoPlace) return;
      ScanWindow window;
      window.open(kWindowBits);
      mark_rays(rays, window);
      const std::set<std::uint64_t> found = missed_cells(window);
      std::set<std::uint64_t> expected;
      for (const Cell& cell : segment.cells()) expected.insert(place_of(cell));
      for (const Cell& cell : segment.cells()) {
        if (!segment.meets(cell, -ExactSegment::kGraze)) continue;
        ASSERT_EQ(found.count(place_of(cell)), 1U);
      }
      cells += found.size();
      if (found == expected) return;
      for (std::int64_t x = -kHalf; x < kHalf; ++x) {
        for (std::int64_t y = -kHalf; y < kHalf; ++y) {
          for (std::int64_t z = -kHalf; z < kHalf; ++z) {
            if (found.count(place_of({x, y, z})) != 0) {
              ASSERT_TRUE(segment.meets({x, y, z}, ExactSegment::kGraze));
            }
          }
        }
      }
    });
  }
  EXPECT_GT(cells, test::rounds(20'000));
}

}  // namespace
}  // namespace pingvox::detail
