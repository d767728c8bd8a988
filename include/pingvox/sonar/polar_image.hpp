#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pingvox/sonar/sweep.hpp"

namespace pingvox {

/// A sweep as an image: row n is its n-th beam, column i its i-th bin (paper, figure 3). Shorter beams are padded with
/// 0; `bins_in` is the number of bins before the padding.
class PolarImage {
 public:
  enum class Wrap {
    kAround,  ///< full turn: the last row is a neighbour of the first
    kNone,
  };

  explicit PolarImage(const Sweep& sweep);
  /// An image of zeros. `bins_in`: number of bins of each row, all <= columns.
  PolarImage(std::vector<std::size_t> bins_in, std::size_t columns, Wrap wrap);

  std::size_t rows() const { return bins_in_.size(); }
  std::size_t columns() const { return columns_; }
  Wrap wrap() const { return wrap_; }
  std::size_t bins_in(std::size_t row) const { return bins_in_[row]; }

  std::span<std::uint8_t> row(std::size_t n) {
    assert(n < rows());
    return std::span(pixels_).subspan(n * columns_, columns_);
  }
  std::span<const std::uint8_t> row(std::size_t n) const {
    assert(n < rows());
    return std::span(pixels_).subspan(n * columns_, columns_);
  }

 private:
  std::vector<std::size_t> bins_in_;
  std::size_t columns_;
  Wrap wrap_;
  std::vector<std::uint8_t> pixels_;  ///< row by row
};

}  // namespace pingvox
