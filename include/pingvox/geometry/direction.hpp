#pragma once

#include <Eigen/Core>
#include <cmath>

namespace pingvox {

/// The unit vector of a direction of any length.
/// REQUIRES finite components, at least one of them not 0.
inline Eigen::Vector3d unit_vector(const Eigen::Vector3d& direction) {
  if (std::isnormal(direction.squaredNorm())) return direction.normalized();
  // Squares of components below 1e-154 or above 1e154 are 0 or infinite. Powers of two are exact.
  const int exponent = std::ilogb(direction.cwiseAbs().maxCoeff());
  return direction.unaryExpr([exponent](double length) { return std::scalbn(length, -exponent); }).normalized();
}

}  // namespace pingvox
