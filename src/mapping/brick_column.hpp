#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mapping/kernels/convex_rows.hpp"
#include "pingvox/map/scan_update.hpp"

namespace pingvox::detail {

/// Key axes (0 x, 1 y, 2 z) of layers, of rows in a layer, of cells in a row.
struct WalkOrder {
  int layer = 0, row = 1, cell = 2;
};

/// Marks four by four rows of cells at once: a column of bricks. A bit is flipped where a row begins and behind its
/// end; a cell belongs to its row when an odd number of bits up to it are set. So a row costs two bits, however long it
/// is, and a brick is written once.
class BrickColumn {
 public:
  /// @param cells  length of the column; places of cells in it are 4..cells-1
  BrickColumn(const WalkOrder& axes, std::size_t cells)
      : cell_axis_(axes.cell), one_(1 << axes.cell), two_(8 << axes.cell), turned_(cells / 4 + 2) {
    for (unsigned row = 0; row < ColumnOfRows::kRows; ++row) {
      const unsigned first_cell = in_brick(row / 4, axes.layer) + in_brick(row % 4, axes.row);
      first_cells_ |= std::uint64_t{1} << first_cell;
      for (unsigned cell = 0; cell < 4; ++cell) {
        bit_[row][cell] = std::uint64_t{1} << (first_cell + in_brick(cell, axes.cell));
      }
    }
  }

  /// Begin of a row without cells; its end is 0.
  std::int64_t no_place() const { return static_cast<std::int64_t>(turned_.size() - 1) * 4; }

  /// Marks the cells of the rows as missed.
  /// @param lowest  key of the place 0 in row 0: the lowest of a brick, and along the column of a page
  void mark(const RunsOfRows& runs, const WideKey& lowest, ScanUpdate& scan) {
    if (runs.lowest_begin >= runs.highest_end) return;
    turn(runs);
    const auto begin = static_cast<std::size_t>(runs.lowest_begin), end = static_cast<std::size_t>(runs.highest_end);
    const std::size_t brick_row = ScanUpdate::cell_in_page(lowest) / 64;
    std::uint64_t inside = 0;  // rows that go on, as bits of their first cells in a brick
    std::uint32_t page = 0;
    std::size_t next_page = 0;  // its first brick
    for (std::size_t at = begin / 4; at <= end / 4; ++at) {
      const std::uint64_t odd = odd_up_to_each(turned_[at]);
      turned_[at] = 0;
      const std::uint64_t cells = odd ^ inside * (1 | one_cell(one_) | one_cell(two_) | one_cell(one_ + two_));
      inside ^= odd >> (one_ + two_) & first_cells_;
      if (cells == 0) continue;
      if (at >= next_page) {
        page = scan.page_of(along(lowest, at / 4 * 16));
        next_page = at / 4 * 4 + 4;
      }
      scan.mark_missed_in(page, brick_row | in_brick(static_cast<unsigned>(at % 4), cell_axis_), cells);
    }
  }

 private:
  /// Bits that a coordinate 0..3 along an axis adds to the number of a cell in its brick, or of a brick in its page.
  static constexpr unsigned in_brick(unsigned coordinate, int axis) {
    return ((coordinate >> 1) * 8U + (coordinate & 1U)) << axis;
  }
  static constexpr std::uint64_t one_cell(int bit) { return std::uint64_t{1} << bit; }

  void turn(const RunsOfRows& runs) {
    for (std::size_t row = 0; row < ColumnOfRows::kRows; ++row) {
      const auto begin = static_cast<std::size_t>(runs.begin[row]), end = static_cast<std::size_t>(runs.end[row]);
      turned_[begin / 4] ^= bit_[row][begin % 4];
      turned_[end / 4] ^= bit_[row][end % 4];
    }
  }

  /// For each cell of a brick whether an odd number of bits of its row are set up to it.
  std::uint64_t odd_up_to_each(std::uint64_t bits) const {
    bits ^= (bits & (first_cells_ | first_cells_ << two_)) << one_;
    const std::uint64_t second = bits & first_cells_ << one_;
    return bits ^ second << two_ ^ second << (two_ - one_);
  }

  WideKey along(const WideKey& key, std::size_t cells) const {
    const auto by = [&](int axis) { return axis == cell_axis_ ? cells : 0; };
    return {key.x + by(0), key.y + by(1), key.z + by(2)};
  }

  int cell_axis_;
  int one_, two_;  ///< what one and two cells along a row add to a cell's number in its brick
  std::uint64_t first_cells_ = 0;
  std::array<std::array<std::uint64_t, 4>, ColumnOfRows::kRows> bit_{};
  std::vector<std::uint64_t> turned_;
};

}  // namespace pingvox::detail
