#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::bench {

/// An echo as direction and range.
struct BeamEcho {
  double bearing_rad = 0.0;
  double range_m = 0.0;
  std::uint8_t intensity = 0;
};

/// The complete sweeps of tank_beams() with the echoes of the default detector; beams without one are omitted.
struct TankEchoes {
  std::string input;  ///< as in TankBeams
  std::vector<std::vector<BeamEcho>> sweeps;
};
Result<TankEchoes> tank_echoes();

/// Rays of one scan [m], in single precision, as in liboctomap's clouds.
struct RayCloud {
  Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();
  std::vector<Eigen::Vector3f> ends_m;
};

/// One ray from the origin for each echo, in the plane of the head.
RayCloud rays_of(const std::vector<BeamEcho>& sweep);

/// The same with each echo as a bundle of `across` x `up` rays of its range, spread evenly over 3 x 35 degrees.
RayCloud bundles_of(const std::vector<BeamEcho>& sweep, int across, int up);

/// The first sweeps of tank_echoes(), each echo as a bundle of 32 x 64 rays.
struct TankBundles {
  std::string input;  ///< as in TankBeams
  std::vector<RayCloud> scans;
};
Result<TankBundles> tank_bundles(std::size_t sweeps);

}  // namespace pingvox::bench
