#include "pingvox/map/cast_ray.hpp"

#include <gtest/gtest.h>

#include <limits>

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

}  // namespace
