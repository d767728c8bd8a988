#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Where a vehicle shall go: on a smooth curve through all these points.
struct Route {
  enum class End {
    kStays,   ///< it stays at the last point
    kStarts,  ///< it goes on to the first point and round again
  };
  std::vector<Eigen::Vector3d> waypoints_m;  ///< at least two, no two in a row the same
  End end = End::kStays;
};

struct TravelOptions {
  double speed_m_s = 0.25;     ///< > 0, at most 100
  double pose_every_s = 0.25;  ///< > 0, at most 3600

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Length [m] of a route's curve, of a round the way back to the start included.
double length_m(const Route& route);

/// The way of a vehicle that looks where it goes and stays level, from time 0 until `duration_s` at least.
/// REQUIRES valid options, 0 < duration_s, at most 10 million poses.
Trajectory travelled(const Route& route, double duration_s, const TravelOptions& options);

/// How what a vehicle believes of its way goes astray: a random walk of its position and its heading, which starts with
/// the truth. A wrong heading also turns the way on from there.
struct DriftOptions {
  std::uint64_t seed = 1;
  double position_m = 0.0;   ///< standard deviation along x and along y, each, after a minute; >= 0
  double heading_rad = 0.0;  ///< standard deviation after a minute; >= 0

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// What a vehicle reports of a true way: poses at the same times. Depth, roll and pitch do not drift: they are
/// measured. REQUIRES valid options.
Trajectory reported(const Trajectory& truth, const DriftOptions& options);

}  // namespace pingvox
