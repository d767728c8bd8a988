// The factor of a sparse matrix of blocks against Eigen's dense solvers.

#include "slam/least_squares/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <utility>

#include "tests/slam/least_squares/random_matrix.hpp"
#include "tests/support/uniform.hpp"

namespace pingvox::test {
namespace {

/// The same matrix twice.
struct Problem {
  LowerBlocks sparse;
  Eigen::MatrixXd dense;
};

/// J'J of a chain with random loops, residuals of one row each, and a weak prior. Weights are up to `stiffness`.
Problem random_problem(std::size_t columns, std::size_t loops, double stiffness, std::mt19937_64& random) {
  const auto size = static_cast<Eigen::Index>(3 * columns);
  std::set<std::pair<std::size_t, std::size_t>> joined;  // column, row
  const auto any_column = [&] { return static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(columns))); };
  for (std::size_t c = 0; c < columns; ++c) {
    joined.emplace(c, c);
    if (c + 1 < columns) joined.emplace(c, c + 1);
  }
  for (std::size_t i = 0; i < loops; ++i) {
    const std::size_t a = any_column(), b = any_column();
    joined.emplace(std::min(a, b), std::max(a, b));
  }
  Problem problem;
  problem.dense = Eigen::MatrixXd::Identity(size, size);
  for (const auto& [a, b] : joined) {
    for (int i = 0; i < 4; ++i) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
      row.segment<3>(static_cast<Eigen::Index>(3 * a)) += random_matrix(3, 1, random);
      row.segment<3>(static_cast<Eigen::Index>(3 * b)) += random_matrix(3, 1, random);
      problem.dense += (i == 0 ? stiffness : 1.0) * row * row.transpose();
    }
  }
  problem.sparse.starts.assign(columns + 1, 0);
  for (const auto& [column, row] : joined) {
    problem.sparse.starts[column + 1] = problem.sparse.rows.size() + 1;
    problem.sparse.rows.push_back(static_cast<std::uint32_t>(row));
    problem.sparse.blocks.emplace_back(
        problem.dense.block<3, 3>(static_cast<Eigen::Index>(3 * row), static_cast<Eigen::Index>(3 * column)));
  }
  return problem;
}

TEST(BlockCholesky, SolvesAndInvertsAsDenseSolvers) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    const std::size_t columns = 1 + seed % 30;
    const Problem problem = random_problem(columns, seed % 17, 10.0, random);
    const auto factor = BlockCholesky::factor(problem.sparse);
    ASSERT_TRUE(factor);
    const Eigen::MatrixXd right = random_matrix(problem.dense.rows(), static_cast<Eigen::Index>(1 + seed % 5), random);
    EXPECT_TRUE(factor->solve(right).isApprox(problem.dense.ldlt().solve(right), 1e-10));
    const Eigen::MatrixXd inverse = problem.dense.inverse();
    const auto diagonal = factor->inverse_diagonal();
    ASSERT_EQ(diagonal.size(), columns);
    for (std::size_t c = 0; c < columns; ++c) {
      const auto from = static_cast<Eigen::Index>(3 * c);
      EXPECT_TRUE(diagonal[c].isApprox(inverse.block<3, 3>(from, from), 1e-9)) << c;
    }
  }
}

TEST(BlockCholesky, SolvesForNoRightSide) {
  const auto factor = BlockCholesky::factor({.starts = {0, 1}, .rows = {0}, .blocks = {Eigen::Matrix3d::Identity()}});
  ASSERT_TRUE(factor);
  const Eigen::MatrixXd solved = factor->solve(Eigen::MatrixXd(3, 0));
  EXPECT_EQ(solved.rows(), 3);
  EXPECT_EQ(solved.cols(), 0);
}

// Inverses of blocks lose what one direction of a stiff block leaves to the others.
TEST(BlockCholesky, SolvesStiffSystems) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    const Problem problem = random_problem(30, 20, 1e12, random);
    const auto factor = BlockCholesky::factor(problem.sparse);
    ASSERT_TRUE(factor);
    const Eigen::VectorXd right = random_matrix(problem.dense.rows(), 1, random);
    const Eigen::VectorXd solved = factor->solve(right);
    const double residual = (problem.dense * solved - right).norm();
    EXPECT_LE(residual, 1e-14 * (problem.dense.norm() * solved.norm() + right.norm()));
  }
}

TEST(BlockCholesky, RefusesWhatIsNotPositiveDefinite) {
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  LowerBlocks matrix{.starts = {0, 2, 3}, .rows = {0, 1, 1}, .blocks = {one, 0.99 * one, one}};
  EXPECT_TRUE(BlockCholesky::factor(matrix));
  matrix.blocks[1] = 1.01 * one;
  EXPECT_FALSE(BlockCholesky::factor(matrix));
}

}  // namespace
}  // namespace pingvox::test
