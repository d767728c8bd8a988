#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/elevation_tables.hpp"
#include "pingvox/mapping/beam_model.hpp"

namespace pingvox::detail {

/// The rays of a beam as a grid: each elevation with each azimuth. `beam_bundle` lists them.
struct BundleGrid {
  struct Level {
    double x, y;  ///< unit, in the plane of the head
  };
  std::vector<Level> azimuths;
  const Elevations& elevations;  ///< valid until the tables that it came from are used again
  double divisor;                ///< see share_on_arc

  Eigen::Vector3d direction(std::size_t elevation, const Level& azimuth) const {
    const double across = elevations.across[elevation];
    return {across * azimuth.x, across * azimuth.y, elevations.up[elevation]};
  }
  /// Of the echo's evidence.
  double share(std::size_t elevation) const { return elevations.pattern[elevation] / divisor; }
};

double width_of(const BeamModelOptions& options);
double height_of(const BeamModelOptions& options);

/// @param tables  of height_of(options)
BundleGrid bundle_grid(const BeamModelOptions& options, double bearing_rad, double range_m, double resolution_m,
                       ElevationTables& tables);

}  // namespace pingvox::detail
