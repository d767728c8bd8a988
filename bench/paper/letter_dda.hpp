#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace pingvox::bench {

/// How the paper's traversal ends when it has not met its end cell.
enum class LetterStop {
  kBeyondLength,  ///< all its parameters are beyond the ray's length: "can lead to missing voxels", figure 11
  kTravelled,     ///< it is farther from the start than the end cell is: "a slight snapping", figure 12
};

/// The paper's DDA by the letter of section 6.1: parameters in floating point that are added up face by face, until the
/// end cell is met or `stop` says so. The start cell included, the end cell not.
/// @tparam Real      float or double: the paper does not say
/// @param from, to   [m]
template <class Real>
std::vector<std::array<std::int64_t, 3>> letter_dda(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                                    double resolution_m, LetterStop stop);

extern template std::vector<std::array<std::int64_t, 3>> letter_dda<float>(const Eigen::Vector3d&,
                                                                           const Eigen::Vector3d&, double, LetterStop);
extern template std::vector<std::array<std::int64_t, 3>> letter_dda<double>(const Eigen::Vector3d&,
                                                                            const Eigen::Vector3d&, double, LetterStop);

}  // namespace pingvox::bench
