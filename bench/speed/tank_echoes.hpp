#pragma once

#include <string>
#include <vector>

#include "pingvox/map/point_scan.hpp"
#include "pingvox/result.hpp"

namespace pingvox::bench {

/// An echo of one beam, as a direction and a range: what is left of it once it is detected.
struct BeamEcho {
  double bearing_rad = 0.0;
  double range_m = 0.0;
  std::uint8_t intensity = 0;
};

/// The complete sweeps of the paper's recording with the echoes that the defaults find; beams without one are left out.
/// Where the recording is not there, 28 sweeps of the simulated tank (seed 1) stand in for it.
struct TankEchoes {
  std::string input;  ///< "recording" or "simulated"
  std::vector<std::vector<BeamEcho>> sweeps;
};
Result<TankEchoes> tank_echoes();

/// One ray for each echo, in the plane of the head; the sensor is at the origin. Coordinates are those of floats, so
/// that liboctomap can be given the same.
PointScan rays_of(const std::vector<BeamEcho>& sweep);

/// Each echo as a bundle of `across` x `up` rays, evenly over 3 x 35 degrees on the sphere, all with the echo's range.
PointScan bundles_of(const std::vector<BeamEcho>& sweep, int across, int up);

}  // namespace pingvox::bench
