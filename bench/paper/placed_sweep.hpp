#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/mapping/build_map.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox::bench {

/// A beam, its echo, and where the head was.
struct PlacedBeam {
  Beam beam;
  std::optional<Echo> echo;
  Pose map_from_sonar;

  /// The point of its axis at a range [m, map frame].
  Eigen::Vector3d at(double range_m) const;
};
using PlacedSweep = std::vector<PlacedBeam>;

/// Beams as build_map places them: cut into sweeps, with the echoes of its default detector. Beams at times that the
/// trajectory does not cover are left out.
std::vector<PlacedSweep> place_sweeps(std::span<const Beam> beams, const Trajectory& map_from_sonar);

/// Echoes in the plane, in the order of the beams.
std::vector<std::vector<Eigen::Vector2d>> echoes_in_plane(std::span<const PlacedSweep> sweeps);

}  // namespace pingvox::bench
