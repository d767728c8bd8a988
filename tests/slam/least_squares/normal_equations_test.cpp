// The normal equations with their border against Eigen's dense solver.

#include "slam/least_squares/normal_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "tests/slam/least_squares/random_matrix.hpp"

namespace pingvox::test {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

TEST(NormalEquations, SolveLoopsAndBorderAsDenseOnes) {
  std::mt19937_64 random(7);
  constexpr Eigen::Index kKnots = 9, kGlobals = 4, kSize = 3 * kKnots + kGlobals;
  // Both orders of a pair, and one given twice.
  const Pairs pairs = {{0, 1}, {1, 2}, {2, 3}, {4, 3}, {4, 5}, {5, 6}, {6, 7}, {7, 8}, {8, 0}, {2, 7}, {7, 2}, {5, 1}};
  NormalEquations equations(kKnots, kGlobals, pairs);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kSize, kSize);
  for (const auto& [a, b] : pairs) {
    // Residuals of two knots and the globals.
    const Eigen::MatrixXd by = random_matrix(12, 6 + kGlobals, random);
    const Eigen::MatrixXd square = by.transpose() * by;
    const Eigen::Vector<Eigen::Index, 2> at(3 * Eigen::Index{a}, 3 * Eigen::Index{b});
    for (Eigen::Index i = 0; i < 2; ++i) {
      for (Eigen::Index j = 0; j < 2; ++j) {
        dense.block<3, 3>(at[i], at[j]) += square.block<3, 3>(3 * i, 3 * j);
      }
      dense.block<3, kGlobals>(at[i], 3 * kKnots) += square.block<3, kGlobals>(3 * i, 6);
      dense.block<kGlobals, 3>(3 * kKnots, at[i]) += square.block<kGlobals, 3>(6, 3 * i);
      equations.border.middleRows<3>(at[i]) += square.block<3, kGlobals>(3 * i, 6);
    }
    dense.bottomRightCorner<kGlobals, kGlobals>() += square.bottomRightCorner<kGlobals, kGlobals>();
    equations.corner += square.bottomRightCorner<kGlobals, kGlobals>();
    equations.add_block(a, a, square.block<3, 3>(0, 0));
    equations.add_block(b, b, square.block<3, 3>(3, 3));
    equations.add_block(a, b, square.block<3, 3>(0, 3));
  }
  const Eigen::VectorXd gradient = random_matrix(kSize, 1, random);
  equations.gradient = gradient;

  const auto step = equations.solve();
  ASSERT_TRUE(step);
  const Eigen::VectorXd expected = -dense.ldlt().solve(gradient);
  EXPECT_TRUE(step->knots.isApprox(expected.head(3 * kKnots), 1e-9));
  EXPECT_TRUE(step->globals.isApprox(expected.tail(kGlobals), 1e-9));
  const Eigen::MatrixXd covariance = dense.inverse();
  EXPECT_TRUE(step->global_covariance.isApprox(covariance.bottomRightCorner<kGlobals, kGlobals>(), 1e-8));
  const auto of_knots = equations.knot_covariances();
  ASSERT_TRUE(of_knots);
  ASSERT_EQ(of_knots->size(), std::size_t{kKnots});
  for (Eigen::Index k = 0; k < kKnots; ++k) {
    EXPECT_TRUE((*of_knots)[static_cast<std::size_t>(k)].isApprox(covariance.block<3, 3>(3 * k, 3 * k), 1e-8)) << k;
  }
}

TEST(NormalEquations, SayWhenAnUnknownIsFree) {
  NormalEquations equations(2, 1, Pairs{{0, 1}});
  equations.add_block(0, 0, Eigen::Matrix3d::Identity());
  equations.corner.setIdentity();
  EXPECT_FALSE(equations.solve());
  EXPECT_FALSE(equations.knot_covariances());
}

}  // namespace
}  // namespace pingvox::test
