#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

class OptionErrors;

/// A smooth curve through waypoints.
struct Route {
  enum class End {
    kStays,   ///< stay at the last waypoint
    kStarts,  ///< continue with the first waypoint, as a loop
  };
  std::vector<Eigen::Vector3d> waypoints_m;  ///< at least two, consecutive ones different
  End end = End::kStays;
};

struct TravelOptions {
  double speed_m_s = 0.25;     ///< > 0, at most 100
  double pose_every_s = 0.25;  ///< > 0, at most 3600

  OptionErrors errors() const;    ///< what is wrong with each field
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Length [m] of a route's curve; of a loop including the way back to the start.
double length_m(const Route& route);

/// Trajectory of a vehicle that heads along the route and stays level, from time 0 to at least `duration_s`.
/// REQUIRES valid options, 0 < duration_s, at most 10 million poses.
Trajectory follow_route(const Route& route, double duration_s, const TravelOptions& options);

/// Trajectory of a vehicle that somebody drives along the route, once, from time 0: at half to one and a half times the
/// speed, swaying, with stops, and with sudden turns where it stops. The same seed gives the same numbers.
/// REQUIRES valid options, at most 10 million poses.
Trajectory drive_by_hand(const Route& route, const TravelOptions& options, std::uint64_t seed);

/// Drift of dead reckoning: a random walk of position and heading that starts at the ground truth. A heading error also
/// rotates the rest of the path.
struct DriftOptions {
  std::uint64_t seed = 1;
  double position_m = 0.0;   ///< standard deviation along x and along y, each, after a minute; >= 0
  double heading_rad = 0.0;  ///< standard deviation after a minute; >= 0

  OptionErrors errors() const;    ///< what is wrong with each field
  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// A true trajectory as a drifting vehicle reports it. Depth, roll and pitch are measured and do not drift. REQUIRES
/// valid options.
Trajectory add_drift(const Trajectory& truth, const DriftOptions& options);

}  // namespace pingvox
