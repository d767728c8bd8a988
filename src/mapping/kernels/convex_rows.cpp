#include "mapping/kernels/convex_rows.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace pingvox::detail {
namespace {

constexpr std::size_t kRowsInLayer = 4;
// Numbers of layers; of rows in a column: of their layers, and in these.
constexpr std::array<double, 16> kNumbers{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
constexpr std::array<double, 16> kLayerNumbers{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
constexpr std::array<double, 16> kRowNumbers{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};

#define PINGVOX_LOOPS "mapping/kernels/convex_rows_loops.hpp"
#include "map/kernels/each_machine.hpp"

}  // namespace

void find_rows(const ConvexBody& body, std::int64_t first_layer, RowsOfLayers& rows, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, find_rows(body, first_layer, rows), plain::find_rows(body, first_layer, rows));
}

void find_cells(const ConvexBody& body, const ColumnOfRows& column, RunsOfRows& runs, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, find_cells(body, column, runs), plain::find_cells(body, column, runs));
}

}  // namespace pingvox::detail
