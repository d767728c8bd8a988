#pragma once

#include <Eigen/Core>
#include <vector>

#include "pingvox/mapping/beam_model.hpp"

namespace pingvox::detail {

/// The rays of a beam by what they are made of: each elevation with each azimuth. `beam_bundle` spells them out.
struct BundleGrid {
  struct Level {
    double x, y;  ///< unit, in the plane of the head
  };
  std::vector<Level> azimuths;
  /// Cosine and sine of each elevation; behind them is room for detail::kEndsAtOnce more.
  std::vector<double> across, up;
  std::vector<double> shares;  ///< of each elevation: its share of the echo's evidence

  Eigen::Vector3d direction(std::size_t elevation, const Level& azimuth) const {
    return {across[elevation] * azimuth.x, across[elevation] * azimuth.y, up[elevation]};
  }
};

double width_of(const BeamModelOptions& options);
double height_of(const BeamModelOptions& options);

/// @see beam_bundle
BundleGrid bundle_grid(const BeamModelOptions& options, double bearing_rad, double range_m, double resolution_m);

}  // namespace pingvox::detail
