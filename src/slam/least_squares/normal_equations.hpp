#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "slam/least_squares/block_cholesky.hpp"

namespace pingvox {

/// J'J and J'r of a least-squares problem of knots, three unknowns each, and of globals that any residual may depend
/// on: blocks of knots that share a residual, and the globals as a dense border.
class NormalEquations {
 public:
  /// Pairs of knots (either order, repeated or not) that share residuals; each knot's own block is always there.
  NormalEquations(std::size_t knots, std::size_t globals,
                  std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);

  /// Adds J'J to the block of row-knot `a` and column-knot `b`, given as of a residual's part for `a` times that for
  /// `b`. REQUIRES a pair of the constructor.
  void add_block(std::size_t a, std::size_t b, const Eigen::Matrix3d& block);

  Eigen::MatrixXd border;    ///< 3 knots x globals
  Eigen::MatrixXd corner;    ///< globals x globals
  Eigen::VectorXd gradient;  ///< J'r: knots, then globals

  struct Step {
    Eigen::VectorXd knots, globals;
    Eigen::MatrixXd global_covariance;
  };
  /// The Gauss-Newton step. nullopt: the problem does not determine its unknowns.
  std::optional<Step> solve() const;

  /// Covariance of each knot's unknowns: the diagonal blocks of the inverse. nullopt as above.
  std::optional<std::vector<Eigen::Matrix3d>> knot_covariances() const;

 private:
  std::size_t slot(std::size_t row, std::size_t column) const;

  LowerBlocks matrix_;  ///< of the knots
};

}  // namespace pingvox
