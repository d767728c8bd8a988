#pragma once

#include <Eigen/Core>
#include <random>

#include "tests/support/uniform.hpp"

namespace pingvox::test {

/// Each element uniform in -1..1.
inline Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::mt19937_64& random) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random, -1.0, 1.0); });
}

}  // namespace pingvox::test
