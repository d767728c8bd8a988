#include "slam/normal_equations.hpp"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cassert>

namespace pingvox {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

}  // namespace

NormalEquations::NormalEquations(std::size_t knots, std::size_t globals,
                                 std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs)
    : knots_(knots) {
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
  starts_.assign(knots + 1, 0);
  rows_.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    ++starts_[(key >> 32) + 1];
    rows_.push_back(static_cast<std::uint32_t>(key));
  }
  for (std::size_t k = 0; k < knots; ++k) starts_[k + 1] += starts_[k];
  blocks_.assign(rows_.size(), Eigen::Matrix3d::Zero());
}

std::size_t NormalEquations::slot(std::size_t row, std::size_t column) const {
  const auto first = rows_.begin() + static_cast<std::ptrdiff_t>(starts_[column]);
  const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(starts_[column + 1]);
  const auto found = std::lower_bound(first, end, row);
  assert(found != end && *found == row);
  return static_cast<std::size_t>(found - rows_.begin());
}

void NormalEquations::add_block(std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
  if (a >= b) {
    blocks_[slot(a, b)] += block;
  } else {
    blocks_[slot(b, a)] += block.transpose();
  }
}

std::optional<NormalEquations::Step> NormalEquations::solve() const {
  const auto size = static_cast<Eigen::Index>(3 * knots_);
  // Ordering the knots instead of their unknowns is nine times less work.
  Eigen::SparseMatrix<double> pattern(static_cast<Eigen::Index>(knots_), static_cast<Eigen::Index>(knots_));
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * rows_.size());
  for (std::size_t c = 0; c < knots_; ++c) {
    for (std::size_t s = starts_[c]; s < starts_[c + 1]; ++s) {
      const auto row = static_cast<int>(rows_[s]), column = static_cast<int>(c);
      entries.emplace_back(row, column, 1.0);
      if (row != column) entries.emplace_back(column, row, 1.0);
    }
  }
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> from_place;
  Eigen::AMDOrdering<int>()(pattern, from_place);
  const Eigen::VectorXi places =
      Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>(from_place.inverse()).indices();

  // The lower triangle of the ordered matrix, column by column.
  std::vector<std::vector<std::pair<int, std::size_t>>> columns(knots_);  // row, slot
  for (std::size_t c = 0; c < knots_; ++c) {
    for (std::size_t s = starts_[c]; s < starts_[c + 1]; ++s) {
      const int a = places[static_cast<Eigen::Index>(rows_[s])], b = places[static_cast<Eigen::Index>(c)];
      columns[static_cast<std::size_t>(std::min(a, b))].emplace_back(std::max(a, b), s);
    }
  }
  Sparse lower(size, size);
  lower.reserve(static_cast<Eigen::Index>(9 * rows_.size()));
  for (std::size_t c = 0; c < knots_; ++c) {
    std::ranges::sort(columns[c]);
    for (int j = 0; j < 3; ++j) {
      lower.startVec(static_cast<Eigen::Index>(3 * c) + j);
      for (const auto& [row, s] : columns[c]) {
        const bool is_turned = places[static_cast<Eigen::Index>(rows_[s])] != row;
        for (int i = static_cast<std::size_t>(row) == c ? j : 0; i < 3; ++i) {
          lower.insertBack(3 * row + i, static_cast<Eigen::Index>(3 * c) + j) =
              is_turned ? blocks_[s](j, i) : blocks_[s](i, j);
        }
      }
    }
  }
  lower.finalize();
  Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> factor(lower);
  if (factor.info() != Eigen::Success || (factor.vectorD().array() <= 0.0).any()) return std::nullopt;

  // The border and the gradient in the order of the factor; the globals by the Schur complement.
  const Eigen::Index globals = corner.cols();
  Eigen::MatrixXd right(size, globals + 1);
  for (std::size_t k = 0; k < knots_; ++k) {
    const auto from = static_cast<Eigen::Index>(3 * k),
               to = static_cast<Eigen::Index>(3) * places[static_cast<Eigen::Index>(k)];
    if (globals > 0) right.block(to, 0, 3, globals) = border.middleRows(from, 3);
    right.block(to, globals, 3, 1) = -gradient.segment(from, 3);
  }
  const Eigen::MatrixXd solved = factor.solve(right);
  const Eigen::MatrixXd schur = corner - right.leftCols(globals).transpose() * solved.leftCols(globals);
  const Eigen::LDLT<Eigen::MatrixXd> schur_factor(schur);
  if (schur_factor.info() != Eigen::Success || !schur_factor.isPositive()) return std::nullopt;
  Step step;
  step.globals =
      schur_factor.solve(-gradient.tail(globals) - right.leftCols(globals).transpose() * solved.col(globals));
  const Eigen::VectorXd ordered = solved.col(globals) - solved.leftCols(globals) * step.globals;
  step.knots.resize(size);
  for (std::size_t k = 0; k < knots_; ++k) {
    step.knots.segment(static_cast<Eigen::Index>(3 * k), 3) =
        ordered.segment(static_cast<Eigen::Index>(3) * places[static_cast<Eigen::Index>(k)], 3);
  }
  step.global_covariance = schur_factor.solve(Eigen::MatrixXd::Identity(globals, globals));
  step.factor_entries = static_cast<std::size_t>(factor.matrixL().nestedExpression().nonZeros());
  if (!step.knots.allFinite() || !step.globals.allFinite()) return std::nullopt;
  return step;
}

}  // namespace pingvox
