#include "pingvox/map/cast_ray.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "geometry/internal/ray_dda.hpp"
#include "support/rounds.hpp"

using namespace pingvox;

namespace {

OccupancyMap map_with(int depth, const WideKey& cell, float belief) {
  OccupancyMap map({.resolution_m = 1.0, .depth = depth});
  Editor editor = map.edit();
  editor.set(cell, depth, LogOdds(belief));
  return map;
}

TEST(CastRay, EndsWhereItEntersTheFirstOccupiedCell) {
  const OccupancyMap map = map_with(8, {138, 128, 128}, 1.0F);
  const RayEnd hit = cast_ray(map, {0.5, 0.5, 0.5}, {2.0, 0.0, 0.0}, 100.0);
  EXPECT_EQ(hit.what, Occupancy::kOccupied);
  EXPECT_EQ(hit.key, (WideKey{138, 128, 128}));
  EXPECT_DOUBLE_EQ(hit.range_m, 9.5);
  EXPECT_EQ(cast_ray(map, {0.5, 0.5, 0.5}, {1.0, 0.0, 0.0}, 9.4).what, Occupancy::kFree);
  EXPECT_DOUBLE_EQ(cast_ray(map, {0.5, 0.5, 0.5}, {1.0, 0.0, 0.0}, 9.4).range_m, 9.4);
  EXPECT_EQ(cast_ray(map, {0.5, 0.5, 0.5}, {-1.0, 0.0, 0.0}, 100.0).what, Occupancy::kFree);
  const RayEnd inside = cast_ray(map, {10.5, 0.5, 0.5}, {0.0, 1.0, 0.0}, 5.0);
  EXPECT_EQ(inside.what, Occupancy::kOccupied);
  EXPECT_EQ(inside.range_m, 0.0);
}

TEST(CastRay, TakesDirectionsOfAnyLength) {
  const OccupancyMap map = map_with(8, {138, 128, 128}, 1.0F);
  const Eigen::Vector3d direction(1.0, 0.01, -0.02);
  const RayEnd expected = cast_ray(map, {0.5, 0.5, 0.5}, direction, 100.0);
  EXPECT_EQ(expected.what, Occupancy::kOccupied);
  for (const double length : {5e-324, 1e-310, 1e-200, 1e-160, 1e-3, 1e160, 1e308}) {
    SCOPED_TRACE(length);
    // Components below 1e-308 have few digits.
    const RayEnd end = cast_ray(map, {0.5, 0.5, 0.5}, length * direction, 100.0);
    EXPECT_EQ(end.what, Occupancy::kOccupied);
    EXPECT_NEAR(end.range_m, expected.range_m, 0.01);
  }
}

TEST(CastRay, IsStoppedByUnknownCellsOnlyWhenAsked) {
  OccupancyMap map = map_with(8, {138, 128, 128}, 1.0F);
  {
    Editor editor = map.edit();
    for (WideWord x = 128; x < 135; ++x) editor.update(WideKey{x, 128, 128}, LogOdds(-1.0F));
  }
  const RayEnd blocked = cast_ray(map, {0.5, 0.5, 0.5}, {1.0, 0.0, 0.0}, 100.0, UnknownCells::kBlock);
  EXPECT_EQ(blocked.what, Occupancy::kUnknown);
  EXPECT_EQ(blocked.key, (WideKey{135, 128, 128}));
  EXPECT_DOUBLE_EQ(blocked.range_m, 6.5);
  EXPECT_EQ(cast_ray(map, {0.5, 0.5, 0.5}, {1.0, 0.0, 0.0}, 100.0).what, Occupancy::kOccupied);
}

TEST(CastRay, EndsAtTheBorderOfTheLatticeAndDoesNotComeInAgainOnTheOtherSide) {
  for (const int depth : {1, 2, 8, 16}) {
    SCOPED_TRACE(depth);
    const double border = std::ldexp(1.0, depth - 1);
    const WideWord last = (WideWord{1} << depth) - 1, half = WideWord{1} << (depth - 1);
    // A ray that wraps would hit this cell, on the other side.
    const OccupancyMap low = map_with(depth, {0, half, half}, 1.0F), high = map_with(depth, {last, half, half}, 1.0F);
    const double x = std::nextafter(border, 0.0);
    const RayEnd ahead = cast_ray(low, {x, 0.5, 0.5}, {1.0, 0.0, 0.0}, 10.0);
    EXPECT_EQ(ahead.what, Occupancy::kFree);
    EXPECT_EQ(ahead.key, (WideKey{last, half, half}));
    EXPECT_LE(ahead.range_m, 1e-6);
    const RayEnd back = cast_ray(high, {-border, 0.5, 0.5}, {-1.0, 0.0, 0.0}, 10.0);
    EXPECT_EQ(back.what, Occupancy::kFree);
    EXPECT_EQ(back.key, (WideKey{0, half, half}));
    EXPECT_EQ(back.range_m, 0.0);
    const RayEnd crossing = cast_ray(low, {-0.5, 0.5, 0.5}, {1.0, 0.0, 0.0}, 1e12);
    EXPECT_EQ(crossing.what, depth == 1 ? Occupancy::kOccupied : Occupancy::kFree);
    if (depth > 1) {
      EXPECT_NEAR(crossing.range_m, border + 0.5, 1e-6);
    }
  }
}

TEST(CastRay, RunsAlongTheLowestBorder) {
  const OccupancyMap map = map_with(8, {200, 0, 0}, 1.0F);
  const RayEnd end = cast_ray(map, {-128.0, -128.0, -128.0}, {1.0, 0.0, 0.0}, 300.0);
  EXPECT_EQ(end.what, Occupancy::kOccupied);
  EXPECT_DOUBLE_EQ(end.range_m, 200.0);
}

TEST(CastRay, FromOutsideOfTheLatticeSeesNothing) {
  const OccupancyMap map = map_with(8, {200, 0, 0}, 1.0F);
  for (const double x : {128.0, -128.1, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    const RayEnd end = cast_ray(map, {x, 0.0, 0.0}, {1.0, 1.0, 0.0}, 10.0);
    EXPECT_EQ(end.what, Occupancy::kUnknown);
    EXPECT_EQ(end.range_m, 0.0);
  }
}

/// Cell by cell from the root, as the contract reads.
RayEnd plain_cast(const OccupancyMap& map, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                  double max_range_m, UnknownCells unknown) {
  const Lattice& lattice = map.lattice();
  const auto start = lattice.key_of<WideWord>(origin_m);
  if (!start) return {Occupancy::kUnknown, {}, 0.0};
  const double border_m = 0.5 * lattice.cell_size_m(0);
  const Eigen::Vector3d way_m = direction.normalized() * max_range_m;
  double share = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double room_m = way_m[axis] > 0.0 ? border_m - origin_m[axis] : border_m + origin_m[axis];
    if (std::abs(way_m[axis]) > room_m) share = std::min(share, std::max(0.0, room_m / std::abs(way_m[axis])));
  }
  const Eigen::Vector3d inside_m = way_m * share;
  const double range_m = inside_m.norm(), cells_per_m = 1.0 / lattice.resolution_m();
  FaceCrossings crossings(origin_m * cells_per_m, (origin_m + inside_m) * cells_per_m);
  const WideWord half = WideWord{1} << (lattice.depth() - 1), last = half - 1 + half;
  WideKey key = *start;
  for (double entered_m = 0.0;; crossings.cross(crossings.next_axis())) {
    const Occupancy what = map.classify(key);
    const bool blocks = what == Occupancy::kUnknown && unknown == UnknownCells::kBlock;
    if (what == Occupancy::kOccupied || blocks) return {what, key, entered_m};
    if (crossings.left() == 0) return {Occupancy::kFree, key, range_m};
    entered_m = crossings.share_at_next() * range_m;
    const std::size_t axis = crossings.next_axis();
    WideWord& word = component(key, axis);
    if (word == (crossings.is_ahead(axis) ? last : 0)) return {Occupancy::kFree, key, entered_m};
    word = crossings.is_ahead(axis) ? word + 1 : word - 1;
  }
}

/// Leaves of all sizes around the middle, most of them free, few occupied.
OccupancyMap random_map(int depth, std::mt19937_64& random) {
  OccupancyMap map({.resolution_m = 0.5, .depth = depth, .thresholds = {LogOdds(-0.5F), LogOdds(0.5F)}});
  const WideWord middle = WideWord{1} << (depth - 1);
  const WideWord reach = std::min<WideWord>(middle, 40);
  Editor editor = map.edit(random() % 4 == 0 ? Pruning::kNever : Pruning::kLazy);
  for (int i = 0; i < 300; ++i) {
    const auto word = [&] { return middle - reach + static_cast<WideWord>(random()) % (2 * reach); };
    const int levels = static_cast<int>(random() % 4);
    const float belief = random() % 12 == 0 ? 1.0F : (random() % 12 == 0 ? 0.0F : -1.0F);
    editor.set(WideKey{word(), word(), word()}, std::max(0, depth - levels), LogOdds(belief));
  }
  return map;
}

TEST(CastRay, EndsWhereTheWalkFromCellToCellEnds) {
  std::size_t ends[3] = {}, border = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(300); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const int depths[] = {1, 2, 3, 5, 8, 16, 33, 52, 64, 65, 128};
    const int depth = depths[seed % std::size(depths)];
    const OccupancyMap map = seed % 50 == 0 ? OccupancyMap({.depth = depth}) : random_map(depth, random);
    const double reach_m = std::min(std::ldexp(0.5, depth - 1), 30.0);
    std::uniform_real_distribution<double> place(-reach_m, reach_m);
    for (int ray = 0; ray < 60; ++ray) {
      SCOPED_TRACE(ray);
      Eigen::Vector3d origin_m(place(random), place(random), place(random));
      Eigen::Vector3d way(place(random), place(random), place(random));
      // Onto faces and centres, along axes and diagonals: many faces at once.
      if (ray % 3 == 0) origin_m = (origin_m * 4.0).array().floor() / 4.0;
      if (ray % 4 == 0) way = way.array().sign();
      if (ray % 8 == 0) way[static_cast<int>(random() % 3)] = 0.0;
      if (way.norm() == 0.0) continue;
      const double range_m = ray % 5 == 0 ? 5000.0 : place(random) + reach_m + 0.1;
      const UnknownCells unknown = ray % 7 == 0 ? UnknownCells::kBlock : UnknownCells::kPass;
      const RayEnd plain = plain_cast(map, origin_m, way, range_m, unknown);
      const RayEnd end = cast_ray(map, origin_m, way, range_m, unknown);
      ASSERT_EQ(end.what, plain.what);
      ASSERT_EQ(end.key, plain.key);
      ASSERT_EQ(end.range_m, plain.range_m);
      ++ends[static_cast<std::size_t>(end.what)];
      border += end.what == Occupancy::kFree && end.range_m < range_m - 1e-9;
    }
  }
  EXPECT_GT(ends[0], test::rounds(1'000));
  EXPECT_GT(ends[1], test::rounds(1'000));
  EXPECT_GT(ends[2], test::rounds(500));
  EXPECT_GT(border, test::rounds(500));
}

// The longest that is walked node by node, and the first that is not.
TEST(CastRay, FarAndNearRaysEndAlike) {
  const OccupancyMap map = map_with(20, {(1U << 19) + 32'767, 1U << 19, 1U << 19}, 1.0F);
  for (const double range_m : {32'766.0, 32'767.0, 32'768.0, 32'769.0, 40'000.0}) {
    const RayEnd end = cast_ray(map, {0.5, 0.5, 0.5}, {1.0, 0.0, 0.0}, range_m);
    EXPECT_EQ(end.what, range_m < 32'767.0 ? Occupancy::kFree : Occupancy::kOccupied) << range_m;
    EXPECT_NEAR(end.range_m, std::min(range_m, 32'766.5), 1e-5) << range_m;
  }
}

}  // namespace
