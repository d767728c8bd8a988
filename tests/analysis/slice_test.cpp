#include "pingvox/analysis/slice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pingvox {
namespace {

using testing::HasSubstr;

constexpr LogOdds kOccupied{2.0F}, kWater{-2.0F};

/// Cells of 0.5 m in the column over x = 0.25, y = 0.25, from z = 0 upwards: '#' occupied, '.' free, ' ' unknown.
OccupancyMap column(std::string_view cells) {
  OccupancyMap map({.resolution_m = 0.5});
  Editor editor = map.edit();
  double z = 0.25;
  for (const char cell : cells) {
    const Key key = *map.lattice().key_of(Eigen::Vector3d(0.25, 0.25, z));
    if (cell != ' ') editor.set(key, 16, cell == '#' ? kOccupied : kWater);
    z += 0.5;
  }
  editor.synchronize();
  return map;
}

/// What the only column of a slice is: '#', '.', ' '; 'x' when there is no slice.
char draw_slice(std::string_view cells, const SliceOptions& options) {
  const auto slice = slice_of(column(cells), options);
  if (!slice) return 'x';
  EXPECT_EQ(slice->values.size(), 1U);
  return " .#"[static_cast<int>(slice->values.front())];
}

TEST(Slice, OfAColumnIsItsMostOccupiedCell) {
  EXPECT_EQ(draw_slice("..#.", {}), '#');
  EXPECT_EQ(draw_slice(". ..", {}), '.');
  EXPECT_EQ(draw_slice("..#.", {0.0, 1.0}), '.');
  EXPECT_EQ(draw_slice("..#.", {1.5, 9.0}), '.');
  EXPECT_EQ(draw_slice("##  ", {1.5, 1.5}), 'x') << "nothing is known there";
}

TEST(Slice, EndsWithAFaceAndOneHeightIsOneLayer) {
  EXPECT_EQ(draw_slice(".#..", {0.0, 0.5}), '.') << "does not reach into the layer above";
  EXPECT_EQ(draw_slice(".#..", {0.0, 0.51}), '#');
  EXPECT_EQ(draw_slice(".#..", {0.5, 0.5}), '#') << "a point on a face is in the cell above";
  EXPECT_EQ(draw_slice(".#..", {0.49, 0.49}), '.');
  EXPECT_EQ(draw_slice(".#..", {1.0, std::nullopt}), '.');
  EXPECT_EQ(draw_slice("#...", {std::nullopt, 0.5}), '#');
  EXPECT_EQ(draw_slice("#...", {-1e9, 1e9}), '#') << "heights outside of the lattice";
  EXPECT_EQ(draw_slice("#...", {1e8, 1e9}), 'x');
}

// Kills a height that is a rounding below its face: -1.12 m is 56.00000000000001 cells of 2 cm below the origin.
TEST(Slice, AHeightOnAFaceIsInTheCellAbove) {
  for (const double cell_m : {0.01, 0.02, 0.05, 0.1}) {
    OccupancyMap map({.resolution_m = cell_m});
    const auto layers = {-300, -112, -56, -55, -28, -14, -3, -1, 0, 1, 3, 14, 29, 57, 113};
    {
      Editor editor = map.edit();
      for (const int layer : layers) {
        const auto key = map.lattice().key_of(Eigen::Vector3d(0.5 * cell_m, 0.5 * cell_m, (layer + 0.5) * cell_m));
        editor.set(*key, 16, layer % 2 == 0 ? kOccupied : kWater);
      }
    }
    for (const int layer : layers) {
      const double z_m = layer * cell_m;
      const auto at = slice_of(map, {z_m, z_m});
      ASSERT_TRUE(at) << z_m;
      EXPECT_EQ(at->values.front(), layer % 2 == 0 ? Occupancy::kOccupied : Occupancy::kFree) << z_m;
      const auto from = map_of_slice(map, {z_m, std::nullopt});
      ASSERT_TRUE(from) << z_m;
      EXPECT_NEAR(from->bounds()->min.z(), z_m, 1e-9);
    }
  }
}

// Kills a map of a slice that needs a raster as wide as the map.
TEST(Slice, OfAWideMapWithFewCellsIsAMap) {
  OccupancyMap map({.resolution_m = 0.02});
  {
    Editor editor = map.edit();
    for (const Eigen::Vector3d& place : {Eigen::Vector3d(-200, -200, 0.01), Eigen::Vector3d(200, 200, 0.01)}) {
      editor.set(*map.lattice().key_of(place), 16, kOccupied);
    }
  }
  const auto raster = slice_of(map, {0.0, 0.0});
  ASSERT_FALSE(raster);
  EXPECT_EQ(raster.error().code, Error::Code::kLimit);
  EXPECT_TRUE(check_slice(map, {0.0, 0.0}));
  const auto layer = map_of_slice(map, {0.0, 0.0});
  ASSERT_TRUE(layer) << layer.error().message;
  EXPECT_EQ(layer->bounds()->max.x(), map.bounds()->max.x());
}

TEST(Slice, KeepsUnknownApartFromFree) {
  OccupancyMap map({.resolution_m = 1.0});
  {
    Editor editor = map.edit();
    editor.set(*map.lattice().key_of(Eigen::Vector3d(-0.5, 4.5, 0.5)), 16, kWater);
    editor.set(*map.lattice().key_of(Eigen::Vector3d(1.5, 5.5, 0.5)), 16, kOccupied);
  }
  const auto slice = slice_of(map, {});
  ASSERT_TRUE(slice);
  EXPECT_EQ(slice->columns, 3U);
  EXPECT_EQ(slice->rows, 2U);
  EXPECT_EQ(slice->corner_m, Eigen::Vector2d(-1.0, 4.0));
  EXPECT_EQ(slice->cell_m, 1.0);
  EXPECT_EQ(slice->at(0, 0), Occupancy::kFree);
  EXPECT_EQ(slice->at(1, 0), Occupancy::kUnknown);
  EXPECT_EQ(slice->at(2, 1), Occupancy::kOccupied);
}

TEST(Slice, TakesTheThresholdsOfTheMap) {
  OccupancyMap map({.resolution_m = 1.0, .thresholds = {LogOdds(-1.0F), LogOdds(1.0F)}});
  map.edit().set(*map.lattice().key_of(Eigen::Vector3d(0.5, 0.5, 0.5)), 16, LogOdds(0.5F));
  const auto slice = slice_of(map, {});
  ASSERT_TRUE(slice);
  EXPECT_EQ(slice->values, std::vector{Occupancy::kUnknown});
}

TEST(Slice, AgreesWithEachCellLookedUp) {
  std::size_t compared = 0;
  for (const int depth : {3, 16, 70}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      SCOPED_TRACE(testing::Message() << "depth " << depth << ", seed " << seed);
      std::mt19937_64 random(seed);
      OccupancyMap map({.resolution_m = 0.1, .depth = depth});
      const auto centre = [&] { return (static_cast<double>(random() % 8) - 3.5) * 0.1; };
      {
        Editor editor = map.edit();
        for (int i = 0; i < 40; ++i) {
          const auto key = *map.lattice().key_of<WideWord>(Eigen::Vector3d(centre(), centre(), centre()));
          editor.set(key, depth - static_cast<int>(random() % 2), random() % 3 == 0 ? kOccupied : kWater);
        }
      }
      const double low = centre(), high = low + 0.1 * static_cast<double>(random() % 4);
      const auto slice = slice_of(map, {low, high});
      const auto heights = heights_of(map, {low, high}, Surface::kHighest);
      const auto lowest = heights_of(map, {low, high}, Surface::kLowest);
      if (!slice) continue;
      for (std::size_t row = 0; row < slice->rows; ++row) {
        for (std::size_t column = 0; column < slice->columns; ++column) {
          const double x = slice->corner_m.x() + 0.1 * (static_cast<double>(column) + 0.5);
          const double y = slice->corner_m.y() + 0.1 * (static_cast<double>(row) + 0.5);
          Occupancy expected = Occupancy::kUnknown;
          double top = std::nan(""), bottom = std::nan("");
          for (double z = low; z <= high + 0.01; z += 0.1) {
            const Occupancy cell = map.classify(Eigen::Vector3d(x, y, z));
            expected = std::max(expected, cell);
            if (cell != Occupancy::kOccupied) continue;
            top = z + 0.05;
            bottom = std::fmin(bottom, z + 0.05);
          }
          ASSERT_EQ(slice->at(column, row), expected);
          ASSERT_EQ(heights.has_value(), lowest.has_value());
          if (expected == Occupancy::kOccupied) {
            ASSERT_NEAR(static_cast<double>(heights->at(column, row)), top, 1e-6);
            ASSERT_NEAR(static_cast<double>(lowest->at(column, row)), bottom, 1e-6);
          } else if (heights) {
            ASSERT_TRUE(std::isnan(heights->at(column, row)));
          }
          ++compared;
        }
      }
    }
  }
  EXPECT_GT(compared, 1000U);
}

TEST(Slice, OutOfProportionIsRefusedBeforeItTakesMemory) {
  OccupancyMap map({.resolution_m = 0.05});
  map.edit().set(Key{0, 0, 0}, 1, kWater);  // an eighth of all there is
  const auto slice = slice_of(map, {});
  ASSERT_FALSE(slice);
  EXPECT_EQ(slice.error().code, Error::Code::kLimit);
  EXPECT_THAT(slice.error().message, HasSubstr("32768 x 32768 cells"));
  OccupancyMap deepest({.resolution_m = 1e-20, .depth = 128});
  deepest.edit().set(WideKey{}, 0, kOccupied);
  EXPECT_FALSE(slice_of(deepest, {}));
  EXPECT_FALSE(heights_of(deepest, {}, Surface::kHighest));
}

TEST(Slice, OfNothingIsNone) {
  EXPECT_THAT(slice_of(OccupancyMap(), {}).error().message, "nothing is known");
  EXPECT_THAT(slice_of(column("#"), {3.0, 4.0}).error().message, "nothing is known at heights 3..4 m");
  EXPECT_THAT(heights_of(column("."), {}, Surface::kHighest).error().message, "nothing is occupied");
  EXPECT_EQ(slice_of(column("#"), {1.0, 0.0}).error().code, Error::Code::kBadOption);
  EXPECT_EQ(slice_of(column("#"), {std::nan(""), 0.0}).error().code, Error::Code::kBadOption);
}

}  // namespace
}  // namespace pingvox
