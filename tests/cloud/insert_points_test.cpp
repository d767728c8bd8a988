#include "pingvox/cloud/insert_points.hpp"

#include <gtest/gtest.h>

#include <vector>

using namespace pingvox;

namespace {

// Kills hits or misses that are left out, evidence that is not the one asked for, points outside that are not counted.
TEST(InsertPoints, PointsAreHitAndCellsBeforeThemMissed) {
  OccupancyMap map({.resolution_m = 1.0});
  const std::vector<Eigen::Vector3d> points_m{{3.5, 0.5, 0.5}, {0.5, 2.5, 0.5}, {1e9, 0.0, 0.0}};
  const InsertOptions options{.scan = {.hit = LogOdds(1.5F)}, .miss = LogOdds(-0.25F)};
  const auto report = insert_points(map, {0.5, 0.5, 0.5}, points_m, options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->outside, 1U);
  EXPECT_EQ(report->applied.cells_hit, 2U);
  EXPECT_EQ(report->applied.cells_freed, 4U);
  EXPECT_EQ(map.at(Eigen::Vector3d(3.5, 0.5, 0.5)), LogOdds(1.5F));
  EXPECT_EQ(map.at(Eigen::Vector3d(0.5, 1.5, 0.5)), LogOdds(-0.25F));
  EXPECT_EQ(map.at(Eigen::Vector3d(1.5, 1.5, 0.5)), std::nullopt);
}

// Kills rays that take all memory, and limits on rays that are not traced.
TEST(InsertPoints, RaysThatAreTooLongAreRefused) {
  OccupancyMap map({.resolution_m = 1.0, .depth = 32});
  const std::vector<Eigen::Vector3d> points_m{{3.5, 0.5, 0.5}, {2e6, 0.0, 0.0}};
  const auto refused = insert_points(map, {0.5, 0.5, 0.5}, points_m);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Error::Code::kLimit);
  EXPECT_TRUE(map.empty());
  EXPECT_TRUE(insert_points(map, {0.5, 0.5, 0.5}, points_m, {.scan = {.max_range_m = 100.0}}));
  OccupancyMap small({.resolution_m = 1.0});
  EXPECT_TRUE(insert_points(small, {0.5, 0.5, 0.5}, points_m)) << "outside of the lattice";
}

// Kills an insertion that fails and changes the map all the same.
TEST(InsertPoints, AMapAtItsLimitStaysAsItWas) {
  OccupancyMap map({.resolution_m = 1.0, .memory_limit_bytes = 1000});
  const std::vector<Eigen::Vector3f> points_m{{90.5F, 0.5F, 0.5F}};
  const auto report = insert_points(map, {0.5, 0.5, 0.5}, points_m);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, Error::Code::kLimit);
  EXPECT_TRUE(map.empty());
}

}  // namespace
