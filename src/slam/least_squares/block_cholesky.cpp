#include "slam/least_squares/block_cholesky.hpp"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>

namespace pingvox {
namespace {

using Eigen::Matrix3d;

constexpr std::uint32_t kNoColumn = std::numeric_limits<std::uint32_t>::max();

/// Of each column its place in an order that fills in little.
std::vector<std::uint32_t> order_columns(const LowerBlocks& matrix) {
  const auto size = static_cast<Eigen::Index>(matrix.columns());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * matrix.rows.size());
  for (std::size_t c = 0; c < matrix.columns(); ++c) {
    for (std::size_t s = matrix.starts[c]; s < matrix.starts[c + 1]; ++s) {
      const auto row = static_cast<int>(matrix.rows[s]), column = static_cast<int>(c);
      entries.emplace_back(row, column, 1.0);
      if (row != column) entries.emplace_back(column, row, 1.0);
    }
  }
  Eigen::SparseMatrix<double> pattern(size, size);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> from_place;
  Eigen::AMDOrdering<int>()(pattern, from_place);
  std::vector<std::uint32_t> places(matrix.columns());
  for (Eigen::Index place = 0; place < size; ++place) {
    places[static_cast<std::size_t>(from_place.indices()[place])] = static_cast<std::uint32_t>(place);
  }
  return places;
}

/// Blocks of the lower triangle in the order of `places`; the rows of a column in no order.
LowerBlocks ordered(const LowerBlocks& matrix, const std::vector<std::uint32_t>& places) {
  LowerBlocks result;
  result.starts.assign(matrix.columns() + 1, 0);
  const auto each = [&](const auto& of_block) {
    for (std::size_t c = 0; c < matrix.columns(); ++c) {
      for (std::size_t s = matrix.starts[c]; s < matrix.starts[c + 1]; ++s) {
        of_block(s, places[matrix.rows[s]], places[c]);
      }
    }
  };
  each([&](std::size_t, std::uint32_t row, std::uint32_t column) { ++result.starts[std::min(row, column) + 1]; });
  for (std::size_t c = 0; c < matrix.columns(); ++c) result.starts[c + 1] += result.starts[c];
  result.rows.resize(matrix.rows.size());
  result.blocks.resize(matrix.rows.size());
  std::vector<std::size_t> ends(result.starts.begin(), result.starts.end() - 1);
  each([&](std::size_t s, std::uint32_t row, std::uint32_t column) {
    const std::size_t to = ends[std::min(row, column)]++;
    result.rows[to] = std::max(row, column);
    if (row >= column) {
      result.blocks[to] = matrix.blocks[s];
    } else {
      result.blocks[to] = matrix.blocks[s].transpose();
    }
  });
  return result;
}

}  // namespace

// Column by column, each from those before it that reach it.
std::optional<BlockCholesky> BlockCholesky::factor(const LowerBlocks& matrix) {
  const std::size_t columns = matrix.columns();
  BlockCholesky result;
  result.places_ = order_columns(matrix);
  const LowerBlocks lower = ordered(matrix, result.places_);
  result.diagonal_.reserve(columns);

  std::vector<Matrix3d> sums(columns);                       // of each row
  std::vector<std::uint32_t> summed_in(columns, kNoColumn);  // the column for which a row's sum was begun
  // Of each row a list of the columns before it that have it as their next row, and where they have it.
  std::vector<std::uint32_t> first_at(columns, kNoColumn), next_at(columns, kNoColumn);
  std::vector<std::size_t> at(columns);
  const auto put_on_list = [&](std::uint32_t column, std::size_t of_row) {
    const std::uint32_t row = result.rows_[of_row];
    at[column] = of_row;
    next_at[column] = first_at[row];
    first_at[row] = column;
  };
  std::vector<std::uint32_t> rows;
  for (std::uint32_t j = 0; j < columns; ++j) {
    rows.clear();
    for (std::size_t s = lower.starts[j]; s < lower.starts[j + 1]; ++s) {
      const std::uint32_t row = lower.rows[s];
      sums[row] = lower.blocks[s];
      summed_in[row] = j;
      if (row != j) rows.push_back(row);
    }
    for (std::uint32_t k = first_at[j], next = kNoColumn; k != kNoColumn; k = next) {
      next = next_at[k];
      const std::size_t end = result.starts_[k + 1];
      std::size_t s = at[k];
      const Matrix3d by = result.below_[s].transpose();
      sums[j].noalias() -= result.below_[s] * by;
      if (++s == end) continue;
      put_on_list(k, s);
      for (; s < end; ++s) {
        const std::uint32_t row = result.rows_[s];
        if (summed_in[row] != j) {
          summed_in[row] = j;
          sums[row].setZero();
          rows.push_back(row);
        }
        sums[row].noalias() -= result.below_[s] * by;
      }
    }
    const Eigen::LLT<Matrix3d> diagonal(sums[j]);
    if (diagonal.info() != Eigen::Success) return std::nullopt;
    result.diagonal_.emplace_back(diagonal.matrixL());
    std::ranges::sort(rows);
    for (const std::uint32_t row : rows) {
      result.rows_.push_back(row);
      result.below_.emplace_back(diagonal.matrixL().solve(sums[row].transpose()).transpose());
    }
    result.starts_.push_back(result.rows_.size());
    if (!rows.empty()) put_on_list(j, result.starts_[j]);
  }
  return result;
}

Eigen::MatrixXd BlockCholesky::solve(const Eigen::MatrixXd& right) const {
  if (right.cols() == 0) return right;
  const auto row_of = [](std::size_t column) { return static_cast<Eigen::Index>(3 * column); };
  // Rows of a block lie side by side.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> x(right.rows(), right.cols());
  for (std::size_t c = 0; c < places_.size(); ++c) x.middleRows<3>(row_of(places_[c])) = right.middleRows<3>(row_of(c));
  for (std::size_t j = 0; j < diagonal_.size(); ++j) {
    auto of_j = x.middleRows<3>(row_of(j));
    diagonal_[j].triangularView<Eigen::Lower>().solveInPlace(of_j);
    for (std::size_t s = starts_[j]; s < starts_[j + 1]; ++s) {
      x.middleRows<3>(row_of(rows_[s])).noalias() -= below_[s].lazyProduct(of_j);
    }
  }
  for (std::size_t j = diagonal_.size(); j-- > 0;) {
    auto of_j = x.middleRows<3>(row_of(j));
    for (std::size_t s = starts_[j]; s < starts_[j + 1]; ++s) {
      of_j.noalias() -= below_[s].transpose().lazyProduct(x.middleRows<3>(row_of(rows_[s])));
    }
    diagonal_[j].transpose().triangularView<Eigen::Upper>().solveInPlace(of_j);
  }
  Eigen::MatrixXd result(right.rows(), right.cols());
  for (std::size_t c = 0; c < places_.size(); ++c) {
    result.middleRows<3>(row_of(c)) = x.middleRows<3>(row_of(places_[c]));
  }
  return result;
}

std::vector<Matrix3d> BlockCholesky::inverse_diagonal() const {
  const std::size_t columns = diagonal_.size();
  std::vector<Matrix3d> diagonal(columns), below(below_.size());
  std::vector<Matrix3d> by, sums;
  for (std::size_t j = columns; j-- > 0;) {
    const std::size_t begin = starts_[j], end = starts_[j + 1];
    const Matrix3d inverse = diagonal_[j].triangularView<Eigen::Lower>().solve(Matrix3d::Identity());
    // The column as that of a factor with the identity on its diagonal.
    by.clear();
    for (std::size_t s = begin; s < end; ++s) by.emplace_back(below_[s] * inverse);
    // Of each row i: the sum over the rows k of Z(i, k) L(k, j). Column k of Z has all of the rows after k.
    sums.assign(end - begin, Matrix3d::Zero());
    for (std::size_t k = 0; k < by.size(); ++k) {
      sums[k].noalias() += diagonal[rows_[begin + k]] * by[k];
      std::size_t in_k = starts_[rows_[begin + k]];
      for (std::size_t i = k + 1; i < by.size(); ++i) {
        while (rows_[in_k] < rows_[begin + i]) ++in_k;
        sums[i].noalias() += below[in_k] * by[k];
        sums[k].noalias() += below[in_k].transpose() * by[i];
      }
    }
    diagonal[j] = inverse.transpose() * inverse;
    for (std::size_t k = 0; k < by.size(); ++k) {
      below[begin + k] = -sums[k];
      diagonal[j].noalias() += by[k].transpose() * sums[k];
    }
  }
  std::vector<Matrix3d> result(columns);
  for (std::size_t c = 0; c < columns; ++c) result[c] = diagonal[places_[c]];
  return result;
}

}  // namespace pingvox
