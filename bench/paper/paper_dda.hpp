#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace pingvox::bench {

/// Stopping rule of the paper's traversal when it misses its end cell.
enum class PaperStop {
  kBeyondLength,  ///< all its parameters are beyond the ray's length: "can lead to missing voxels", figure 11
  kTravelled,     ///< farther from the start than the end cell: "a slight snapping", figure 12
};

/// The paper's DDA as in section 6.1: floating-point parameters summed face by face, until the end cell or `stop`.
/// Includes the start cell, not the end cell.
/// @tparam Real      float or double: the paper does not say
/// @param from, to   [m]
template <class Real>
std::vector<std::array<std::int64_t, 3>> paper_dda(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                                   double resolution_m, PaperStop stop);

extern template std::vector<std::array<std::int64_t, 3>> paper_dda<float>(const Eigen::Vector3d&,
                                                                          const Eigen::Vector3d&, double, PaperStop);
extern template std::vector<std::array<std::int64_t, 3>> paper_dda<double>(const Eigen::Vector3d&,
                                                                           const Eigen::Vector3d&, double, PaperStop);

}  // namespace pingvox::bench
