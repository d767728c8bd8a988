#pragma once

#include <cstddef>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Distances between matched positions [m]. rmse^2 = mean^2 + sd^2.
struct ErrorStatistics {
  double mean_m = 0.0, sd_m = 0.0, rmse_m = 0.0, max_m = 0.0;
};

/// Error of a trajectory against a reference in the horizontal plane (x, y), unaligned and after three alignments,
/// since a single one may hide an error or charge it to the wrong part.
struct TrajectoryScore {
  std::size_t poses = 0;    ///< of the reference at whose times the trajectory is known
  std::size_t outside = 0;  ///< the others
  /// Between unaligned positions, also in z [m].
  double max_difference_m = 0.0;

  ErrorStatistics none;         ///< unaligned, for trajectories in the same frame
  ErrorStatistics first_fix;    ///< shifted so that the first matched positions coincide
  ErrorStatistics translation;  ///< shifted by the mean difference
  ErrorStatistics se2;          ///< turned and shifted so that the sum of squares is least
  double se2_turn_rad = 0.0;    ///< by which that alignment turns the trajectory, counter-clockwise

  /// Relative error: of the displacement over each segment of the reference (overlapping, one from each matched pose),
  /// after the turn of SE(2), in metres per metre of the reference's path; root of the mean square. NaN: nothing moved.
  double per_m = 0.0;
  double segment_m = 0.0;  ///< length of these segments: a tenth of the path between the first and last matched pose
};

/// The trajectory is interpolated at the reference's times. Rotations of the reference are not used: it may be of
/// fixes.
/// @return kUnsupported when the two are never known at the same time, or when an error is not finite
Result<TrajectoryScore> score_trajectory(const Trajectory& trajectory, const Trajectory& reference);

}  // namespace pingvox
