// The loops over layers and rows, included by convex_rows.cpp once for each kind of machine (see ray_lanes_loops.hpp).
// Numbers of cells stay doubles, in which they are exact: what each machine can round, compare and choose between.

#include "map/kernels/doubles_loops.hpp"

inline void store(const Doubles& whole, std::int64_t* to) {
  Words words;
  bits_of(whole, words);
  words -= std::bit_cast<std::int64_t>(kWhole);
  std::memcpy(to, &words, sizeof words);
}

// Lanes by twos are quicker put together than one by one.
using TwoDoubles = double __attribute__((vector_size(2 * sizeof(double))));
using TwoWords = std::int64_t __attribute__((vector_size(2 * sizeof(std::int64_t))));

inline bool any_of(const Words& lanes) {
  std::array<TwoWords, kLanes / 2> twos;
  std::memcpy(twos.data(), &lanes, sizeof lanes);
  TwoWords any{};
  for (const TwoWords& two : twos) any |= two;
  return (any[0] | any[1]) != 0;
}

inline double least_of(const Doubles& lanes) {
  std::array<TwoDoubles, kLanes / 2> twos;
  std::memcpy(twos.data(), &lanes, sizeof lanes);
  TwoDoubles least = twos[0];
  for (const TwoDoubles& two : twos) least = two < least ? two : least;
  return least[0] < least[1] ? least[0] : least[1];
}

/// What each row's layer has, of rows from number `at` on: vectors hold rows of two layers at most.
inline void load_of_layers(const double* of_layer, std::size_t at, Doubles& numbers) {
  Doubles in_first;
  load(kLayerNumbers.data(), in_first);
  numbers = in_first == 0.0 ? Doubles{} + of_layer[at / kRowsInLayer]
                            : Doubles{} + of_layer[(at + kLanes - 1) / kRowsInLayer];
}

/// Narrows low..high to where slope * place >= needed; `way` is 1 / slope.
inline void narrow(double slope, double way, const Doubles& needed, Doubles& low, Doubles& high) {
  const Doubles place = needed * way;
  if (slope > 0.0) {
    low = low < place ? place : low;
  } else if (slope < 0.0) {
    high = place < high ? place : high;
  } else {
    high = needed > 0.0 ? Doubles{} - std::numeric_limits<double>::infinity() : high;
  }
}

inline void find_rows(const ConvexBody& body, std::int64_t first_layer, RowsOfLayers& rows) {
  for (std::size_t at = 0; at < RowsOfLayers::kLayers; at += kLanes) {
    Doubles number;
    load(kNumbers.data() + at, number);
    const Doubles layer = number + static_cast<double>(first_layer) + 0.5 - body.in_cell.layer;
    Doubles low = Doubles{} + body.low.row, high = Doubles{} + body.high.row;
    for (const Face& face : body.faces) {
      const Doubles needed = -face.reach - face.normal.layer * layer;
      narrow(face.normal.row, face.row_way, needed - face.most_along_row, low, high);
    }
    Doubles first, last;
    ceil_of(low - 0.5 + body.in_cell.row, first);
    floor_of(high - 0.5 + body.in_cell.row, last);
    // Outside of the box nothing is meant, and huge numbers are no cells.
    const Words some = low <= high;
    first = some ? first : Doubles{} + 1.0;
    last = some ? last : Doubles{};
    std::memcpy(rows.first.data() + at, &first, sizeof first);
    std::memcpy(rows.last.data() + at, &last, sizeof last);
  }
}

/// Narrows the cells first..last of rows to those that the sphere touches.
/// @param left  of the square of the sphere's radius, beyond the rows
inline void cut_by_sphere(double in_cell, const Doubles& left, Doubles& first, Doubles& last) {
  Doubles reach{};
  for (std::size_t l = 0; l < kLanes; ++l) reach[l] = left[l] > 0.0 ? std::sqrt(left[l]) : 0.0;
  reach = reach + 0.5 + kGrazing;
  Doubles from, to;
  ceil_of(-reach - 0.5 + in_cell, from);
  floor_of(reach - 0.5 + in_cell, to);
  first = first < from ? from : first;
  last = left < 0.0 ? first - 1.0 : (to < last ? to : last);
}

inline void find_cells(const ConvexBody& body, const ColumnOfRows& column, RunsOfRows& runs) {
  const Doubles none = Doubles{} + static_cast<double>(column.no_place);
  Doubles lowest = none, highest{};
  for (std::size_t at = 0; at < ColumnOfRows::kRows; at += kLanes) {
    Doubles layer_number, row_number, first_row, last_row;
    load(kLayerNumbers.data() + at, layer_number);
    load(kRowNumbers.data() + at, row_number);
    load_of_layers(column.first_of_layer, at, first_row);
    load_of_layers(column.last_of_layer, at, last_row);
    row_number += static_cast<double>(column.first_row);
    const Doubles layer = layer_number + static_cast<double>(column.first_layer) + 0.5 - body.in_cell.layer;
    const Doubles row = row_number + 0.5 - body.in_cell.row;
    Doubles low = Doubles{} + body.low.cell, high = Doubles{} + body.high.cell;
    for (const Face& face : body.faces) {
      const Doubles needed = -face.reach - face.normal.layer * layer;
      narrow(face.normal.cell, face.cell_way, needed - face.normal.row * row, low, high);
    }
    const Words some = (low <= high) & (row_number >= first_row) & (row_number <= last_row);
    Doubles first, last;
    ceil_of(low - 0.5 + body.in_cell.cell, first);
    floor_of(high - 0.5 + body.in_cell.cell, last);

    const Doubles beyond_layer = (layer < 0.0 ? -layer : layer) - 0.5, beyond_row = (row < 0.0 ? -row : row) - 0.5;
    const Doubles to_layer = beyond_layer > 0.0 ? beyond_layer : Doubles{};
    const Doubles to_row = beyond_row > 0.0 ? beyond_row : Doubles{};
    const Doubles left = body.range * body.range - to_layer * to_layer - to_row * to_row;
    // Most rows end before they come near the sphere, by half a cell at least.
    const Doubles farthest = high > -low ? high : -low;
    if (any_of(some & (farthest * farthest > left))) cut_by_sphere(body.in_cell.cell, left, first, last);

    const Words has_cells = some & (first <= last);
    const Doubles begin = has_cells ? first - static_cast<double>(column.lowest_cell) : none;
    const Doubles end = has_cells ? last + 1.0 - static_cast<double>(column.lowest_cell) : Doubles{};
    lowest = begin < lowest ? begin : lowest;
    highest = end > highest ? end : highest;
    store(begin, runs.begin.data() + at);
    store(end, runs.end.data() + at);
  }
  runs.lowest_begin = static_cast<std::int64_t>(least_of(lowest));
  runs.highest_end = static_cast<std::int64_t>(-least_of(-highest));
}
