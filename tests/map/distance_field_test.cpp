#include "pingvox/map/distance_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "support/room.hpp"

namespace pingvox::test {
namespace {

using testing::HasSubstr;

OccupancyMap map_of(const std::vector<Eigen::Vector3d>& occupied, const std::vector<Eigen::Vector3d>& free) {
  OccupancyMap map({.resolution_m = 0.1});
  auto editor = map.edit();
  for (const auto& p : free) editor.update(*map.lattice().key_of(p), LogOdds(-1.0F));
  for (const auto& p : occupied) editor.update(*map.lattice().key_of(p), LogOdds(1.0F));
  editor.synchronize();
  return map;
}

// Kills a transform that stops at the border of a tile, or takes a cell of another layer.
TEST(DistanceField, EqualsBruteForceOverAllOccupiedCells) {
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::vector<Eigen::Vector3d> occupied, free, above;
  const auto cell = [&] { return 0.1 * (static_cast<double>(random() % 300) - 150.0) + 0.05; };
  for (int i = 0; i < 60; ++i) occupied.emplace_back(cell(), cell(), 0.05);
  for (int i = 0; i < 500; ++i) free.emplace_back(cell(), cell(), -0.05);
  std::vector<Eigen::Vector3d> all = occupied;
  for (int i = 0; i < 60; ++i) all.emplace_back(cell(), cell(), 1.05);
  const auto field = DistanceField::make(map_of(all, free), {-0.25, 0.25, 3.0});
  ASSERT_TRUE(field) << field.error().message;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector2d place(1.1 * cell(), 1.1 * cell());
    const Eigen::Vector2d middle = (place * 10.0).array().floor().matrix() * 0.1 + Eigen::Vector2d::Constant(0.05);
    double nearest = 3.0;
    for (const auto& o : occupied) nearest = std::min(nearest, (o.head<2>() - middle).norm());
    ASSERT_NEAR(field->distance_m(place), nearest, 3.0 / 127.0) << place.transpose();
  }
}

TEST(DistanceField, TellsFreeFromUnknownAndOccupied) {
  const auto field = DistanceField::make(map_of({{1.05, 0.05, 0.05}}, {{0.05, 0.05, 0.05}, {1.05, 0.05, -0.05}}), {});
  ASSERT_TRUE(field);
  EXPECT_EQ(field->classify({0.05, 0.05}), Occupancy::kFree);
  EXPECT_EQ(field->classify({1.05, 0.05}), Occupancy::kOccupied);  // although free below
  EXPECT_EQ(field->classify({2.05, 0.05}), Occupancy::kUnknown);
  EXPECT_EQ(field->value_at(1e9, 0.0), DistanceField::kFar + DistanceField::kUnknown);
  EXPECT_EQ(field->value_at(std::numeric_limits<double>::quiet_NaN(), 0.0),
            DistanceField::kFar + DistanceField::kUnknown);
}

TEST(DistanceField, NamesItsOccupiedColumns) {
  const auto field = DistanceField::make(map_of({{-3.05, 0.25, 0.05}, {9.95, -0.05, 0.05}}, {{0.05, 0.05, 0.05}}), {});
  ASSERT_TRUE(field);
  const auto occupied = field->occupied();
  ASSERT_EQ(occupied.size(), 2U);
  for (const Eigen::Vector2d& place : occupied) {
    const Eigen::Vector2d expected = place.x() < 0.0 ? Eigen::Vector2d(-3.05, 0.25) : Eigen::Vector2d(9.95, -0.05);
    EXPECT_TRUE(place.isApprox(expected, 1e-9)) << place.transpose();
  }
}

TEST(DistanceField, GoesUpToTheFirstWall) {
  const auto field = DistanceField::make(Room().map(), {});
  ASSERT_TRUE(field);
  EXPECT_NEAR(field->clear_range_m({0.0, 0.0}, {-1.0, 0.0}, 10.0), 3.0, 0.06);
  EXPECT_NEAR(field->clear_range_m({0.0, 1.5}, {1.0, 0.0}, 10.0), 2.0, 0.06);
  EXPECT_EQ(field->clear_range_m({0.0, 0.0}, {1.0, 0.0}, 2.5), 2.5);
}

// Kills steps in open water that are longer than nothing is occupied around.
TEST(DistanceField, PassesThroughNothingFarFromWalls) {
  constexpr unsigned kSeed = 3;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::vector<Eigen::Vector3d> occupied;
  const auto metres = [&] { return 0.1 * (static_cast<double>(random() % 600) - 300.0) + 0.05; };
  for (int block = 0; block < 40; ++block) {
    const Eigen::Vector3d corner(metres(), metres(), 0.05);
    for (int i = 0; i < 16; ++i) occupied.emplace_back(corner + 0.1 * Eigen::Vector3d(i % 4, i / 4, 0.0));
  }
  const auto field = DistanceField::make(map_of(occupied, {}), {});
  ASSERT_TRUE(field);
  int met = 0;
  for (int ray = 0; ray < 2000; ++ray) {
    const Eigen::Vector2d from(metres(), metres());
    const double angle = 0.01 * static_cast<double>(random() % 628);
    const Eigen::Vector2d ahead(std::cos(angle), std::sin(angle));
    const double range_m = field->clear_range_m(from, ahead, 50.0);
    met += range_m < 50.0 ? 1 : 0;
    int within = 0;  // corners may be cut
    for (double m = 0.0; m < range_m; m += 0.02) {
      within = field->classify(from + m * ahead) == Occupancy::kOccupied ? within + 1 : 0;
      ASSERT_LE(within, 5) << from.transpose() << " at " << angle << ", " << m;
    }
  }
  EXPECT_GT(met, 100);
}

TEST(DistanceField, OffersPlacesInTheWaterOnly) {
  const auto field = DistanceField::make(Room().map(), {});
  ASSERT_TRUE(field);
  const auto places = field->places(0.2, 0.0);
  EXPECT_NEAR(static_cast<double>(places.size()), 23.0 / 0.04, 60.0);
  for (const auto& place : places) EXPECT_FALSE(Room().is_wall(place.x(), place.y())) << place.transpose();
  EXPECT_NEAR(field->free_area_m2(), 23.0, 0.5);
}

// Kills a step of more cells than integers count.
TEST(DistanceField, OffersPlacesInTheSmallestCells) {
  OccupancyMap map({.resolution_m = 1e-21});
  auto editor = map.edit();
  const auto key = map.lattice().key_of(Eigen::Vector3d::Zero());
  editor.update(*key, LogOdds(1.0F));
  editor.update(*map.lattice().key_of(Eigen::Vector3d(1.5e-21, 0.0, 0.0)), LogOdds(-1.0F));
  editor.synchronize();
  const auto field = DistanceField::make(map, {});
  ASSERT_TRUE(field) << field.error().message;
  EXPECT_LE(field->places(0.1, 0.0).size(), 1U);
  EXPECT_EQ(field->places(1e-21, 0.0).size(), 1U);
}

// Kills a table of all tiles between two far ends that fills the memory.
TEST(DistanceField, RefusesWhatIsEmptyOrTooLarge) {
  const auto nothing = DistanceField::make(OccupancyMap(), {});
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(nothing.error().message, HasSubstr("nothing is occupied between the heights -0.5 and 0.5 m"));

  OccupancyMap wide({.resolution_m = 0.1, .depth = 32});
  auto editor = wide.edit();
  for (const double x : {-1e8, 1e8}) {
    editor.update(*wide.lattice().key_of<std::uint32_t>(Eigen::Vector3d(x, 0.0, 0.0)), LogOdds(1.0F));
  }
  editor.synchronize();
  const auto large = DistanceField::make(wide, {});
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, Error::Code::kLimit);

  for (const DistanceFieldOptions& options : {DistanceFieldOptions{1.0, 0.0}, DistanceFieldOptions{0.0, 1.0, 0.0}}) {
    const auto bad = DistanceField::make(Room().map(), options);
    ASSERT_FALSE(bad);
    EXPECT_EQ(bad.error().code, Error::Code::kBadOption);
  }
}

}  // namespace
}  // namespace pingvox::test
