#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace pingvox {

/// A value for each square of the ground, seen from above.
template <class T>
struct Raster {
  std::size_t columns = 0, rows = 0;  ///< along x, along y
  double cell_m = 0.0;
  Eigen::Vector2d corner_m = Eigen::Vector2d::Zero();  ///< the lowest x and y, map frame
  std::vector<T> values;                               ///< row by row, x fastest, the row of the lowest y first

  const T& at(std::size_t column, std::size_t row) const { return values[row * columns + column]; }
};

}  // namespace pingvox
