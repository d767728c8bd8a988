#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "pingvox/nav/nav_log.hpp"
#include "slam/echo_pairs.hpp"
#include "slam/navigation.hpp"
#include "slam/slam_solver.hpp"

/// How the vehicle moved, by its sonar.
namespace pingvox {

/// The name of the sources that are made here.
inline constexpr std::string_view kSonarSource = "sonar odometry";

struct SonarOdometry {
  NavSource velocity;       ///< in the frame of the body, in the middle between sweeps that match
  NavSource heading;        ///< what it turned, from 0; only of a vehicle whose heading is not known
  std::size_t matched = 0;  ///< sweeps that match the ones before
  bool tells = false;       ///< enough do to tell a trajectory: half of them, without a heading nine of ten
};

/// Matches each sweep with the two before by correlation. Echoes are placed by the heading and by how the vehicle
/// moves, which is found in rounds: all as if it went at one speed, then each sweep where its neighbours lead. A match
/// along a straight wall, or one of two that are as good, says nothing; there the velocity is taken to change evenly.
/// @param heading  of the body; nullptr: not known
SonarOdometry sonar_odometry(std::span<const HeardSweep> sweeps, const SonarMount& body_from_sonar,
                             const HeadingSource* heading);

/// The velocity of such odometry. REQUIRES a sample.
VelocitySource sonar_velocity(const NavSource& source);

}  // namespace pingvox
