#include "slam/least_squares/normal_equations.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>

namespace pingvox {

NormalEquations::NormalEquations(std::size_t knots, std::size_t globals,
                                 std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
  const auto unknowns = static_cast<Eigen::Index>(3 * knots), others = static_cast<Eigen::Index>(globals);
  border = Eigen::MatrixXd::Zero(unknowns, others);
  corner = Eigen::MatrixXd::Zero(others, others);
  gradient = Eigen::VectorXd::Zero(unknowns + others);

  std::vector<std::uint64_t> keys;  // column, row
  keys.reserve(pairs.size() + knots);
  for (const auto& [a, b] : pairs) keys.push_back((std::uint64_t{std::min(a, b)} << 32) | std::max(a, b));
  for (std::uint64_t k = 0; k < knots; ++k) keys.push_back((k << 32) | k);
  std::ranges::sort(keys);
  const auto repeated = std::ranges::unique(keys);
  keys.erase(repeated.begin(), repeated.end());
  matrix_.starts.assign(knots + 1, 0);
  matrix_.rows.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    ++matrix_.starts[(key >> 32) + 1];
    matrix_.rows.push_back(static_cast<std::uint32_t>(key));
  }
  for (std::size_t k = 0; k < knots; ++k) matrix_.starts[k + 1] += matrix_.starts[k];
  matrix_.blocks.assign(matrix_.rows.size(), Eigen::Matrix3d::Zero());
}

std::size_t NormalEquations::slot(std::size_t row, std::size_t column) const {
  const auto first = matrix_.rows.begin() + static_cast<std::ptrdiff_t>(matrix_.starts[column]);
  const auto end = matrix_.rows.begin() + static_cast<std::ptrdiff_t>(matrix_.starts[column + 1]);
  const auto found = std::lower_bound(first, end, row);
  assert(found != end && *found == row);
  return static_cast<std::size_t>(found - matrix_.rows.begin());
}

void NormalEquations::add_block(std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
  if (a >= b) {
    matrix_.blocks[slot(a, b)] += block;
  } else {
    matrix_.blocks[slot(b, a)] += block.transpose();
  }
}

std::optional<NormalEquations::Step> NormalEquations::solve() const {
  const std::optional<BlockCholesky> factor = BlockCholesky::factor(matrix_);
  if (!factor) return std::nullopt;
  // The globals by the Schur complement.
  const auto size = border.rows(), globals = corner.cols();
  Eigen::MatrixXd right(size, globals + 1);
  right << border, -gradient.head(size);
  const Eigen::MatrixXd solved = factor->solve(right);
  const Eigen::MatrixXd schur = corner - border.transpose() * solved.leftCols(globals);
  const Eigen::LDLT<Eigen::MatrixXd> schur_factor(schur);
  if (schur_factor.info() != Eigen::Success || !schur_factor.isPositive()) return std::nullopt;
  Step step;
  step.globals = schur_factor.solve(-gradient.tail(globals) - border.transpose() * solved.col(globals));
  step.knots = solved.col(globals) - solved.leftCols(globals) * step.globals;
  step.global_covariance = schur_factor.solve(Eigen::MatrixXd::Identity(globals, globals));
  if (!step.knots.allFinite() || !step.globals.allFinite()) return std::nullopt;
  return step;
}

std::optional<std::vector<Eigen::Matrix3d>> NormalEquations::knot_covariances() const {
  const std::optional<BlockCholesky> factor = BlockCholesky::factor(matrix_);
  if (!factor) return std::nullopt;
  std::vector<Eigen::Matrix3d> covariances = factor->inverse_diagonal();
  // What the globals add: A^-1 B S^-1 B' A^-1, S the Schur complement.
  if (corner.cols() > 0) {
    const Eigen::MatrixXd by_globals = factor->solve(border);
    const Eigen::LDLT<Eigen::MatrixXd> schur(corner - border.transpose() * by_globals);
    if (schur.info() != Eigen::Success || !schur.isPositive()) return std::nullopt;
    const Eigen::MatrixXd schur_by_globals = schur.solve(by_globals.transpose());
    for (std::size_t k = 0; k < covariances.size(); ++k) {
      const auto from = static_cast<Eigen::Index>(3 * k);
      covariances[k] += by_globals.middleRows<3>(from) * schur_by_globals.middleCols<3>(from);
    }
  }
  const auto is_finite = [](const Eigen::Matrix3d& covariance) { return covariance.allFinite(); };
  if (!std::ranges::all_of(covariances, is_finite)) return std::nullopt;
  return covariances;
}

}  // namespace pingvox
