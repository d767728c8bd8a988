#include "slam/normal_equations.hpp"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cassert>
#include <memory>

namespace pingvox {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// Entries of the inverse of L D L' where the unit lower triangular L, whose diagonal is not stored, is not zero.
struct SparseInverse {
  Eigen::VectorXd diagonal;
  std::vector<double> below;  ///< in the order of L's

  SparseInverse(const Sparse& l, const Eigen::VectorXd& d)
      : diagonal(d.cwiseInverse()), below(static_cast<std::size_t>(l.nonZeros())) {
    const int* rows = l.innerIndexPtr();
    std::vector<double> sums;
    for (Eigen::Index j = l.cols() - 1; j >= 0; --j) {
      const int begin = l.outerIndexPtr()[j], end = l.outerIndexPtr()[j + 1];
      // Of each row i of the column: the sum over its rows k of Z(i, k) L(k, j). Column k has all of the rows after k.
      sums.assign(static_cast<std::size_t>(end - begin), 0.0);
      for (int at = begin; at < end; ++at) {
        const int k = rows[at];
        const double of_k = l.valuePtr()[at];
        double& sum_of_k = sums[static_cast<std::size_t>(at - begin)];
        sum_of_k += of_k * diagonal[k];
        int in_k = l.outerIndexPtr()[k];
        for (int i = at + 1; i < end; ++i) {
          while (rows[in_k] < rows[i]) ++in_k;
          const double entry = below[static_cast<std::size_t>(in_k)];
          sums[static_cast<std::size_t>(i - begin)] += entry * of_k;
          sum_of_k += entry * l.valuePtr()[i];
        }
      }
      for (int at = begin; at < end; ++at) {
        const double sum = sums[static_cast<std::size_t>(at - begin)];
        below[static_cast<std::size_t>(at)] = -sum;
        diagonal[j] += l.valuePtr()[at] * sum;
      }
    }
  }

  /// Entry of a row and column of a block on the diagonal. REQUIRES that L has it: row >= column.
  double at(const Sparse& l, Eigen::Index row, Eigen::Index column) const {
    if (row == column) return diagonal[row];
    const int* first = l.innerIndexPtr() + l.outerIndexPtr()[column];
    const int* end = l.innerIndexPtr() + l.outerIndexPtr()[column + 1];
    const int* found = std::lower_bound(first, end, static_cast<int>(row));
    assert(found != end && *found == row);
    return below[static_cast<std::size_t>(found - l.innerIndexPtr())];
  }
};

}  // namespace

/// Of the blocks of knots, in an order that fills in little.
struct NormalEquations::Factor {
  Eigen::VectorXi places;  ///< of each knot in the order
  Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> ldlt;
};

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

std::unique_ptr<NormalEquations::Factor> NormalEquations::factor() const {
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
  auto factor = std::make_unique<Factor>();
  factor->places = places;
  factor->ldlt.compute(lower);
  if (factor->ldlt.info() != Eigen::Success || (factor->ldlt.vectorD().array() <= 0.0).any()) return nullptr;
  return factor;
}

Eigen::MatrixXd NormalEquations::ordered_border(const Factor& factor) const {
  Eigen::MatrixXd ordered(border.rows(), border.cols());
  for (std::size_t k = 0; k < knots_ && border.cols() > 0; ++k) {
    ordered.middleRows<3>(3 * factor.places[static_cast<Eigen::Index>(k)]) =
        border.middleRows<3>(static_cast<Eigen::Index>(3 * k));
  }
  return ordered;
}

std::optional<NormalEquations::Step> NormalEquations::solve() const {
  const std::unique_ptr<Factor> factor = this->factor();
  if (!factor) return std::nullopt;
  // The border and the gradient in the order of the factor; the globals by the Schur complement.
  const auto size = static_cast<Eigen::Index>(3 * knots_), globals = corner.cols();
  Eigen::MatrixXd right(size, globals + 1);
  if (globals > 0) right.leftCols(globals) = ordered_border(*factor);
  for (std::size_t k = 0; k < knots_; ++k) {
    right.block<3, 1>(3 * factor->places[static_cast<Eigen::Index>(k)], globals) =
        -gradient.segment<3>(static_cast<Eigen::Index>(3 * k));
  }
  const Eigen::MatrixXd solved = factor->ldlt.solve(right);
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
        ordered.segment(static_cast<Eigen::Index>(3) * factor->places[static_cast<Eigen::Index>(k)], 3);
  }
  step.global_covariance = schur_factor.solve(Eigen::MatrixXd::Identity(globals, globals));
  step.factor_entries = static_cast<std::size_t>(factor->ldlt.matrixL().nestedExpression().nonZeros());
  if (!step.knots.allFinite() || !step.globals.allFinite()) return std::nullopt;
  return step;
}

std::optional<std::vector<Eigen::Matrix3d>> NormalEquations::knot_covariances() const {
  const std::unique_ptr<Factor> factor = this->factor();
  if (!factor) return std::nullopt;
  const Sparse& l = factor->ldlt.matrixL().nestedExpression();
  const SparseInverse inverse(l, factor->ldlt.vectorD());
  // What the globals add: A^-1 B S^-1 B' A^-1, S the Schur complement.
  Eigen::MatrixXd by_globals, schur_by_globals;
  if (const Eigen::Index globals = corner.cols(); globals > 0) {
    const Eigen::MatrixXd ordered = ordered_border(*factor);
    by_globals = factor->ldlt.solve(ordered);
    const Eigen::LDLT<Eigen::MatrixXd> schur(corner - ordered.transpose() * by_globals);
    if (schur.info() != Eigen::Success || !schur.isPositive()) return std::nullopt;
    schur_by_globals = schur.solve(by_globals.transpose());
  }
  std::vector<Eigen::Matrix3d> covariances;
  covariances.reserve(knots_);
  for (std::size_t k = 0; k < knots_; ++k) {
    const Eigen::Index from = Eigen::Index{3} * factor->places[static_cast<Eigen::Index>(k)];
    Eigen::Matrix3d covariance;
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        covariance(i, j) = covariance(j, i) = inverse.at(l, from + i, from + j);
      }
    }
    if (by_globals.size() > 0) covariance += by_globals.middleRows<3>(from) * schur_by_globals.middleCols<3>(from);
    if (!covariance.allFinite()) return std::nullopt;
    covariances.push_back(covariance);
  }
  return covariances;
}

}  // namespace pingvox
