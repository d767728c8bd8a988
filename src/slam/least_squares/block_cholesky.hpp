#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace pingvox {

/// The lower triangle of a symmetric matrix in blocks of 3 x 3: of each column its rows, rising, the diagonal first.
struct LowerBlocks {
  std::vector<std::size_t> starts;  ///< of each column in `rows` and `blocks`, and their end
  std::vector<std::uint32_t> rows;
  std::vector<Eigen::Matrix3d> blocks;

  std::size_t columns() const { return starts.size() - 1; }
};

/// L L' of a sparse, symmetric, positive definite matrix in blocks, its rows and columns in an order that fills in
/// little.
class BlockCholesky {
 public:
  /// nullopt: not positive definite.
  static std::optional<BlockCholesky> factor(const LowerBlocks& matrix);

  /// A^-1 of each column of `right`.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;

  /// Diagonal blocks of A^-1, from those of its blocks alone that L has (Takahashi et al. 1973).
  std::vector<Eigen::Matrix3d> inverse_diagonal() const;

 private:
  std::vector<std::uint32_t> places_;      ///< of each column of the matrix in the order
  std::vector<std::size_t> starts_ = {0};  ///< of each column of L in rows_ and below_, and their end
  std::vector<std::uint32_t> rows_;        ///< below the diagonal, rising
  std::vector<Eigen::Matrix3d> below_;
  std::vector<Eigen::Matrix3d> diagonal_;  ///< triangular blocks
};

}  // namespace pingvox
