#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox::bench {

/// What sonar and navigation of a vehicle recorded, and where it was.
struct Drive {
  std::vector<Beam> beams;
  NavLog nav;
  Pose body_from_sonar = Pose::Identity();
  /// Simulated: the true poses. Recorded: fixes of another sensor, which nothing but a score may read.
  Trajectory reference;
};

/// A drive in a world of the simulator, with the defaults of `pingvox simulate --nav`, and a clock that is right.
/// @param turns  of the head; nullopt: until the route ends
/// REQUIRES a motion other than kStill.
Result<Drive> simulate_drive(const Scene& scene, Motion motion, std::optional<std::size_t> turns, std::uint64_t seed);

/// Turns and shifts in the plane what `from` is in onto what `onto` is in: their distances at the poses of `from` have
/// the least sum of squares. @return kUnsupported when they have fewer than two times in common
Result<Pose> align(const Trajectory& from, const Trajectory& onto);
Trajectory move_by(const Pose& by, const Trajectory& trajectory);

/// The abandoned marina of Ribas et al. (2008), as tools/marina gives it to `pingvox slam`. nullopt: it is not there.
Result<std::optional<Drive>> recorded_marina();

}  // namespace pingvox::bench
