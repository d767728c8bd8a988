#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "slam/sweeps/sweep_echoes.hpp"

/// How the vehicle moved, by its sonar.
namespace pingvox {

/// The fewest sweeps that match, without a heading, for a trajectory. A turn that is missed or mistaken bends all
/// that comes after it: in a square tank two sweeps in a row fit after a wrong one, but not many.
inline constexpr std::size_t kMatchesAlone = 5;

/// Two matches are of sweeps that follow each other if they are so many sweeps apart at most. Over a sweep that does
/// not match the vehicle may have stopped or turned.
inline constexpr double kMaxStep_sweeps = 1.6;

/// The name of the sources that are made here, for reports. One of the navigation may have it, too.
inline constexpr std::string_view kSonarSource = "sonar odometry";

/// The motion of the vehicle as estimated from the sonar, for dead reckoning.
struct SonarSources {
  NavSource velocity;                ///< has a sample
  std::optional<NavSource> heading;  ///< nullopt: another source has it
};

struct SonarOdometry {
  NavSource velocity;          ///< in the frame of the body, in the middle between sweeps that match
  NavSource heading;           ///< what it turned, from 0; only of a vehicle whose heading is not known
  std::size_t matched = 0;     ///< sweeps that match the ones before
  bool is_observable = false;  ///< enough match for a trajectory: half of them; without a heading kMatchesAlone, and
                               ///< all but some at the ends, nine of ten
};

/// Matches each sweep with the two before by correlation. Echoes are placed by the heading and by how the vehicle
/// moves, which is found in rounds: all as if it went at one speed, then each sweep where its neighbours lead. A match
/// along a straight wall, or one of two that are as good, says nothing; there the velocity is taken to change evenly.
/// @param heading  of the body; nullptr: not known
SonarOdometry sonar_odometry(std::span<const SweepEchoes> sweeps, const Pose2& body_from_sonar,
                             const HeadingSource* heading);

/// How a measured velocity differs from what the sonar says of the motion.
struct VelocityCheck {
  std::size_t matched = 0;      ///< sweeps that match the ones before
  double difference_m_s = 0.0;  ///< median over these; of each the mean velocity from sweep to sweep
  double over_s = 0.0;          ///< median time from sweep to sweep
  bool contradicts = false;     ///< by more than a mount that is wrong by some 20 degrees explains
};
/// nullopt: too few sweeps match.
/// @param velocity_from_sonar  seen from where the velocity is measured
std::optional<VelocityCheck> check_velocity(const VelocitySource& velocity, std::span<const SweepEchoes> sweeps,
                                            const Pose2& velocity_from_sonar, const HeadingSource& heading);

/// Such odometry of sweeps as they come: what it said of earlier ones stays.
class GrowingOdometry {
 public:
  /// Adds the motion since the last call as estimated from the last sweeps, if any can be; the first ones have to
  /// give a trajectory.
  /// @param sweeps  the last ones; the same as before and those that came since
  void extend(std::span<const SweepEchoes> sweeps, const Pose2& body_from_sonar, const HeadingSource* heading);
  /// Forgets what is not needed from a time on.
  void forget_before(double time_s);

  bool has_motion() const { return !velocity_.samples.empty(); }
  /// Whether a trajectory can still be estimated from the last sweeps.
  bool is_observable_now() const { return is_observable_; }
  /// They do not any more, and no heading says how the vehicle turned meanwhile.
  bool is_lost() const { return has_motion() && !is_observable_ && !has_heading_; }
  std::size_t matched() const { return matched_; }
  /// Of how many steps from sweep to sweep at least so many have to match.
  std::size_t min_matched(std::size_t steps) const;
  /// The velocity, and what the vehicle turned where its heading is not known; until the end of the last sweep as at
  /// the last match. REQUIRES has_motion().
  SonarSources sources() const;

 private:
  NavSource velocity_{std::string(kSonarSource), NavQuantity::kVelocity, {}};
  NavSource heading_{std::string(kSonarSource), NavQuantity::kHeading, {}};
  NavSample last_velocity_, last_heading_;  ///< at the end of the last sweep
  std::size_t matched_ = 0;
  bool has_heading_ = false;  ///< of the vehicle
  bool is_observable_ = false;
};

/// The velocity of such odometry. REQUIRES a sample.
VelocitySource sonar_velocity(const NavSource& source);

}  // namespace pingvox
