#include "mapping/kernels/convex_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/kernels.hpp"
#include "support/uniform.hpp"

namespace pingvox::detail {
namespace {

using test::uniform;

/// Half-spaces all around, some of them along axes, so that something is left more often than not.
ConvexBody random_body(std::mt19937_64& random) {
  ConvexBody body;
  body.range = uniform(random, 1.0, 40.0);
  body.in_cell = {uniform(random, 0.0, 1.0), uniform(random, 0.0, 1.0), uniform(random, 0.0, 1.0)};
  body.low = {uniform(random, -40, 0), uniform(random, -40, 0), uniform(random, -40, 0)};
  body.high = {uniform(random, 0, 40), uniform(random, 0, 40), uniform(random, 0, 40)};
  for (Face& face : body.faces) {
    const auto component = [&] { return random() % 4 == 0 ? 0.0 : uniform(random, -1.0, 1.0); };
    face.normal = {component(), component(), component()};
    face.row_way = 1.0 / face.normal.row;
    face.cell_way = 1.0 / face.normal.cell;
    face.reach = uniform(random, 0.1, 10.0);
    face.max_along_row = std::max(face.normal.cell * body.low.cell, face.normal.cell * body.high.cell);
  }
  return body;
}

bool touches(const ConvexBody& body, double layer, double row, double cell) {
  if (!(cell >= body.low.cell && cell <= body.high.cell)) return false;
  for (const Face& face : body.faces) {
    if (face.normal.layer * layer + face.normal.row * row + face.normal.cell * cell < -face.reach) return false;
  }
  const auto beyond = [](double middle) { return std::max(0.0, std::abs(middle) - 0.5); };
  return std::hypot(beyond(layer), beyond(row), beyond(cell)) <= body.range + kGrazing;
}

// Kills lanes that are mixed up, a vector that ends at the wrong row, a conversion that rounds to nearest, and a sphere
// that is forgotten where only some rows of a vector reach it.
TEST(ConvexRows, EachMachineFindsTheCellsThatBelongToTheBody) {
  std::mt19937_64 random(5);
  constexpr std::int64_t kLowest = -64, kNoPlace = 200;
  std::size_t cells = 0, rows_with_cells = 0;
  for (int n = 0; n < 3000; ++n) {
    SCOPED_TRACE(n);
    const ConvexBody body = random_body(random);
    RowsOfLayers all_rows;
    all_rows.first.fill(-1000.0);
    all_rows.last.fill(1000.0);
    all_rows.last[2] = all_rows.first[2] - 1.0;  // a layer without rows
    ColumnOfRows column;
    column.first_layer = static_cast<std::int64_t>(random() % 60) - 30;
    column.first_row = static_cast<std::int64_t>(random() % 60) - 30;
    column.first_of_layer = all_rows.first.data();
    column.last_of_layer = all_rows.last.data();
    column.lowest_cell = kLowest;
    column.no_place = kNoPlace;
    test::for_each_kernel([&] {
      RunsOfRows runs;
      find_cells(body, column, runs);
      std::int64_t lowest = kNoPlace, highest = 0;
      for (std::size_t r = 0; r < ColumnOfRows::kRows; ++r) {
        const double layer = static_cast<double>(column.first_layer) + static_cast<double>(r / 4) + 0.5;
        const double row = static_cast<double>(column.first_row) + static_cast<double>(r % 4) + 0.5;
        std::int64_t begin = kNoPlace, end = 0;
        for (std::int64_t cell = kLowest; cell < -kLowest && r / 4 != 2; ++cell) {
          if (!touches(body, layer - body.in_cell.layer, row - body.in_cell.row,
                       static_cast<double>(cell) + 0.5 - body.in_cell.cell)) {
            continue;
          }
          begin = std::min(begin, cell - kLowest);
          end = cell - kLowest + 1;
          ++cells;
        }
        EXPECT_EQ(runs.begin[r], begin);
        EXPECT_EQ(runs.end[r], end);
        rows_with_cells += begin < end;
        lowest = std::min(lowest, begin);
        highest = std::max(highest, end);
      }
      EXPECT_EQ(runs.lowest_begin, lowest);
      EXPECT_EQ(runs.highest_end, highest);
    });
  }
  EXPECT_GT(rows_with_cells, 5000U);
  EXPECT_GT(cells, 50'000U);
}

// Kills rows of a layer that are left out although cells of them belong to the body.
TEST(ConvexRows, EachMachineFindsTheRowsOfLayers) {
  std::mt19937_64 random(6);
  std::size_t rows_with_cells = 0;
  for (int n = 0; n < 300; ++n) {
    SCOPED_TRACE(n);
    const ConvexBody body = random_body(random);
    const std::int64_t first_layer = static_cast<std::int64_t>(random() % 60) - 40;
    RowsOfLayers plain;
    hwy::SetSupportedTargetsForTest(HWY_SCALAR);
    find_rows(body, first_layer, plain);
    test::for_each_kernel([&] {
      RowsOfLayers rows;
      find_rows(body, first_layer, rows);
      EXPECT_EQ(rows.first, plain.first);
      EXPECT_EQ(rows.last, plain.last);
    });
    for (std::size_t l = 0; l < RowsOfLayers::kLayers; ++l) {
      for (int row = -45; row < 45; ++row) {
        const double middle = row + 0.5 - body.in_cell.row;
        if (middle < body.low.row || middle > body.high.row) continue;
        const double layer = static_cast<double>(first_layer) + static_cast<double>(l) + 0.5 - body.in_cell.layer;
        for (int cell = -45; cell < 45; ++cell) {
          if (!touches(body, layer, middle, cell + 0.5 - body.in_cell.cell)) continue;
          EXPECT_TRUE(row >= plain.first[l] && row <= plain.last[l]) << "row " << row << " of layer " << l;
          ++rows_with_cells;
          break;
        }
      }
    }
  }
  EXPECT_GT(rows_with_cells, 5000U);
}

}  // namespace
}  // namespace pingvox::detail
