#include "mapping/kernels/convex_rows.hpp"

#include <array>
#include <cmath>
#include <limits>

// Highway compiles what follows up to HWY_AFTER_NAMESPACE once for each kind of machine.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapping/kernels/convex_rows.cpp"
#include <hwy/foreach_target.h>
// It must come after it.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pingvox::detail::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using DoubleVec = hn::Vec<D>;
using Mask = hn::Mask<D>;
constexpr D kDoubles;
constexpr hn::RebindToSigned<D> kInts;

constexpr std::size_t kRowsInLayer = 4;
// Numbers of layers; of rows in a column: of their layers, and in these.
constexpr std::array<double, 16> kNumbers{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
constexpr std::array<double, 16> kLayerNumbers{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
constexpr std::array<double, 16> kRowNumbers{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};

std::size_t lanes() {
  return hn::Lanes(kDoubles);
}
DoubleVec set(double number) {
  return hn::Set(kDoubles, number);
}

/// What each row's layer has, of rows from number `at` on: vectors hold rows of two layers at most.
DoubleVec of_layers(const double* of_layer, std::size_t at) {
  return hn::IfThenElse(hn::FirstN(kDoubles, kRowsInLayer), set(of_layer[at / kRowsInLayer]),
                        set(of_layer[(at + lanes() - 1) / kRowsInLayer]));
}

/// Narrows low..high to where slope * place >= needed; `way` is 1 / slope.
void narrow(double slope, double way, DoubleVec needed, DoubleVec& low, DoubleVec& high) {
  const DoubleVec place = needed * set(way);
  if (slope > 0.0) {
    low = hn::IfThenElse(low < place, place, low);
  } else if (slope < 0.0) {
    high = hn::IfThenElse(place < high, place, high);
  } else {
    high = hn::IfThenElse(needed > hn::Zero(kDoubles), set(-std::numeric_limits<double>::infinity()), high);
  }
}

/// Narrows the cells first..last of rows to those that the sphere touches.
/// @param left  of the square of the sphere's radius, beyond the rows
void cut_by_sphere(double in_cell, DoubleVec left, DoubleVec& first, DoubleVec& last) {
  const DoubleVec zero = hn::Zero(kDoubles), half = set(0.5);
  const DoubleVec reach = hn::Sqrt(hn::Max(left, zero)) + half + set(kGrazing);
  const DoubleVec from = hn::Ceil(hn::Neg(reach) - half + set(in_cell)), to = hn::Floor(reach - half + set(in_cell));
  first = hn::Max(first, from);
  last = hn::IfThenElse(left < zero, first - set(1.0), hn::Min(to, last));
}

void rows_of_layers(const ConvexBody& body, std::int64_t first_layer, RowsOfLayers& rows) {
  for (std::size_t at = 0; at < RowsOfLayers::kLayers; at += lanes()) {
    const DoubleVec number = hn::LoadU(kDoubles, kNumbers.data() + at);
    const DoubleVec layer = number + set(static_cast<double>(first_layer)) + set(0.5) - set(body.in_cell.layer);
    DoubleVec low = set(body.low.row), high = set(body.high.row);
    for (const Face& face : body.faces) {
      const DoubleVec needed = set(-face.reach) - set(face.normal.layer) * layer;
      narrow(face.normal.row, face.row_way, needed - set(face.max_along_row), low, high);
    }
    // Places outside of the box are unused, and huge numbers do not fit a cell index.
    const Mask some = low <= high;
    const DoubleVec first = hn::Ceil(low - set(0.5) + set(body.in_cell.row));
    const DoubleVec last = hn::Floor(high - set(0.5) + set(body.in_cell.row));
    hn::StoreU(hn::IfThenElse(some, first, set(1.0)), kDoubles, rows.first.data() + at);
    hn::StoreU(hn::IfThenElseZero(some, last), kDoubles, rows.last.data() + at);
  }
}

void cells_of_rows(const ConvexBody& body, const ColumnOfRows& column, RunsOfRows& runs) {
  const DoubleVec zero = hn::Zero(kDoubles), half = set(0.5);
  const DoubleVec none = set(static_cast<double>(column.no_place));
  const DoubleVec lowest_cell = set(static_cast<double>(column.lowest_cell));
  DoubleVec lowest = none, highest = zero;
  for (std::size_t at = 0; at < ColumnOfRows::kRows; at += lanes()) {
    const DoubleVec first_row = of_layers(column.first_of_layer, at), last_row = of_layers(column.last_of_layer, at);
    const DoubleVec row_number =
        hn::LoadU(kDoubles, kRowNumbers.data() + at) + set(static_cast<double>(column.first_row));
    const DoubleVec layer_number =
        hn::LoadU(kDoubles, kLayerNumbers.data() + at) + set(static_cast<double>(column.first_layer));
    const DoubleVec layer = layer_number + half - set(body.in_cell.layer),
                    row = row_number + half - set(body.in_cell.row);
    DoubleVec low = set(body.low.cell), high = set(body.high.cell);
    for (const Face& face : body.faces) {
      const DoubleVec needed = set(-face.reach) - set(face.normal.layer) * layer;
      narrow(face.normal.cell, face.cell_way, needed - set(face.normal.row) * row, low, high);
    }
    const Mask some = hn::And(low <= high, hn::And(row_number >= first_row, row_number <= last_row));
    DoubleVec first = hn::Ceil(low - half + set(body.in_cell.cell));
    DoubleVec last = hn::Floor(high - half + set(body.in_cell.cell));

    const DoubleVec to_layer = hn::Max(hn::Abs(layer) - half, zero), to_row = hn::Max(hn::Abs(row) - half, zero);
    const DoubleVec left = set(body.range * body.range) - to_layer * to_layer - to_row * to_row;
    // Most rows end before they come near the sphere, by half a cell at least.
    const DoubleVec farthest = hn::Max(high, hn::Neg(low));
    if (!hn::AllFalse(kDoubles, hn::And(some, farthest * farthest > left))) {
      cut_by_sphere(body.in_cell.cell, left, first, last);
    }

    const Mask has_cells = hn::And(some, first <= last);
    const DoubleVec begin = hn::IfThenElse(has_cells, first - lowest_cell, none);
    const DoubleVec end = hn::IfThenElseZero(has_cells, last + set(1.0) - lowest_cell);
    lowest = hn::Min(begin, lowest);
    highest = hn::Max(end, highest);
    hn::StoreU(hn::ConvertTo(kInts, begin), kInts, runs.begin.data() + at);
    hn::StoreU(hn::ConvertTo(kInts, end), kInts, runs.end.data() + at);
  }
  runs.lowest_begin = static_cast<std::int64_t>(hn::GetLane(hn::MinOfLanes(kDoubles, lowest)));
  runs.highest_end = static_cast<std::int64_t>(hn::GetLane(hn::MaxOfLanes(kDoubles, highest)));
}

}  // namespace

void find_rows_here(const ConvexBody& body, std::int64_t first_layer, RowsOfLayers& rows) {
  rows_of_layers(body, first_layer, rows);
}
void find_cells_here(const ConvexBody& body, const ColumnOfRows& column, RunsOfRows& runs) {
  cells_of_rows(body, column, runs);
}

}  // namespace pingvox::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pingvox::detail {
namespace {
HWY_EXPORT(find_rows_here);
HWY_EXPORT(find_cells_here);
}  // namespace

void find_rows(const ConvexBody& body, std::int64_t first_layer, RowsOfLayers& rows) {
  HWY_DYNAMIC_DISPATCH(find_rows_here)(body, first_layer, rows);
}

void find_cells(const ConvexBody& body, const ColumnOfRows& column, RunsOfRows& runs) {
  HWY_DYNAMIC_DISPATCH(find_cells_here)(body, column, runs);
}

}  // namespace pingvox::detail
#endif
