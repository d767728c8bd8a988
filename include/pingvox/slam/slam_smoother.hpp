#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/distance_field.hpp"
#include "pingvox/nav/clock_offset.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/slam_calibration.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox {

/// Which echoes of different sweeps are matched.
enum class Matching {
  kPairs,  ///< each with the nearest of other sweeps near it, point to line
  kNone,   ///< none: dead reckoning by velocity and headings
};

/// The source of the vehicle's motion from sweep to sweep.
enum class MotionSource {
  kVelocity,  ///< a velocity of the navigation; where a recording has none the sonar, while CausalSlam waits for one
  kSonar,     ///< the sonar: each sweep is matched with those before it
};

struct SlamOptions {
  Matching matching = Matching::kPairs;
  MotionSource motion = MotionSource::kVelocity;
  /// Of CausalSlam: sweeps in the window, kMinCausalSweeps or more; earlier ones are fixed.
  std::size_t causal_sweeps = 80;
  static constexpr std::size_t kMinCausalSweeps = 2;
  std::uint64_t seed = 1;  ///< of the choice among the sweeps near a sweep; equal seeds give equal results

  /// Within 45 degrees of level, or of upside down.
  Pose body_from_sonar = Pose::Identity();
  /// How a source of navigation is mounted: body_from_source by the source's name; the identity for others. Headings
  /// and velocities are turned by it. The sonar is carried by the body at its place relative to the velocity's source.
  std::map<std::string, Pose> body_from_source;
  double nav_offset_s = 0.0;  ///< added to the times of navigation samples to get those of the beams

  /// An earlier calibration of the same sensors: each number is a prior with its standard deviation, instead of the
  /// usual one (docs/slam.md). Headings that it does not have get the usual prior.
  std::optional<SlamCalibration> calibration = std::nullopt;

  /// How echoes are found in logs with intensities. Where a sweep has only one intensity besides 0, echoes were
  /// detected before: each run of bins is one.
  FilterOptions filter;
  double sound_speed_ratio = 1.0;  ///< true speed of sound over the one that the ranges assume, > 0
  EchoOptions echo;

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Covariance of the vehicle's pose at a time by the smoother: too small where walls were mistaken for one another.
struct PoseCovariance {
  double time_s = 0.0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of x, y [m] and yaw [rad] in the map, seen from the first
};

/// Standard deviations of a position, along the direction of the largest one and across it.
struct PlaceEllipse {
  double along_m = 0.0, across_m = 0.0;
  double direction_rad = 0.0;  ///< counter-clockwise from x, in (-pi/2, pi/2]
};
PlaceEllipse place_ellipse(const Eigen::Matrix3d& covariance);

/// The velocity as estimated from the sonar where the navigation has none: each sweep is matched with those before it.
struct SonarMotion {
  std::size_t matched = 0;      ///< sweeps that match
  double noise_m_sqrt_s = 0.0;  ///< standard deviation of the displacement after one second, as assumed
  double drift_m = 0.0;         ///< standard deviation of the last position by this motion alone, without pairs
};

/// How a measured velocity agrees with matches of sweeps.
struct SonarCheck {
  std::size_t sweeps = 0;       ///< that match
  double difference_m_s = 0.0;  ///< median over these
};

struct VelocityReport {
  std::string source;  ///< its name
  std::size_t samples = 0, clipped = 0;
  double longest_gap_s = 0.0;           ///< without a valid sample; between matches where it is by the sonar
  double gaps_by_sonar_s = 0.0;         ///< how long, in gaps of more than a sweep, motion is from the sonar
  std::optional<SonarCheck> check;      ///< nullopt: too few sweeps match, or sweeps were not matched
  std::optional<SonarMotion> by_sonar;  ///< where the navigation has no velocity
};

struct LoopCount {
  std::size_t found = 0, kept = 0;
};

/// Pairs of echoes, in the last iteration of the last solution.
struct PairReport {
  std::size_t count = 0;
  double median_m = 0.0;  ///< median distance from line to point
  /// Pairs of sweeps far apart in time and near in place; kept are those with at least ten pairs that count.
  LoopCount loops;
  /// Submaps of some sweeps that look like one of an earlier time, and how many of these agree with each other: they
  /// moved the trajectory to where pairs were searched. Of CausalSlam those of all solutions, but only where poses were
  /// farther off than pairs can correct.
  LoopCount submap_loops;
};

/// The greatest of each that a solution of CausalSlam had: they do not grow with the log.
struct LargestSolution {
  std::size_t knots = 0;   ///< three unknowns each
  std::size_t echoes = 0;  ///< with those of fixed sweeps
  std::size_t pairs = 0;
};

struct SlamReport {
  std::size_t beams = 0;
  std::size_t in_pauses = 0;  ///< poses in pauses of the sonar; 0 of CausalSlam
  std::size_t sweeps = 0;
  std::size_t echoes = 0;  ///< within the time of the trajectory
  std::size_t knots = 0;
  PairReport pairs;
  VelocityReport velocity;
  std::string heading;  ///< the name of the main heading's source
  /// What is to be added to the times of the main heading, nav_offset_s already added, by the rotation of the sonar
  /// image: 0 if the clocks are right. nullopt: not observable.
  std::optional<ClockOffset> clock_check;
  /// Parameters of the calibration that are hardly observable, in words: more than half of the prior variance remains.
  std::vector<std::string> not_observable;
  /// Parameters of the calibration more than four standard deviations from their prior: a mount, the
  /// navigation of another vehicle, or the clock may be wrong. Also a velocity or a clock that the sonar contradicts.
  std::vector<std::string> implausible;
  std::optional<LargestSolution> largest;  ///< of CausalSlam
};

struct SlamSolution {
  /// map_from_body: x east, y north by the headings, the first pose at 0, 0. At each beam, and in pauses of the
  /// sonar at each velocity, where velocity and heading continue; else pauses are gaps. Of CausalSlam all are.
  Trajectory trajectory;
  SlamCalibration calibration;
  std::vector<PoseCovariance> covariances;  ///< of the knots, some four a sweep; none of CausalSlam
  SlamReport report;
};

/// Poses in a known map, at the beams.
struct MapSolution {
  Trajectory trajectory;  ///< map_from_body; pauses of the sonar are gaps
  SlamCalibration calibration;
  std::vector<PoseCovariance> covariances;  ///< of the knots
  double least_on_walls = 0.0;              ///< the least share of a sweep's echoes on walls of the map
};

/// Trajectory and sensor calibration by one least-squares problem over the whole recording (docs/slam.md): knots of
/// position and heading, calibration, and pairs of echoes of different sweeps.
class SlamSmoother {
 public:
  /// REQUIRES valid options.
  explicit SlamSmoother(SlamOptions options);
  ~SlamSmoother();
  SlamSmoother(SlamSmoother&&) noexcept;
  SlamSmoother& operator=(SlamSmoother&&) noexcept;

  /// Takes the next beam, which must be valid.
  void add(Beam beam);
  /// Takes a sample of a source. Velocity, attitude, heading and depth are used, and turn rates where there is no
  /// heading; others are passed over, as are samples that are not valid.
  /// @return kCorrupt when a number is not finite
  Result<void> add(std::string_view source, NavQuantity quantity, const NavSample& sample);
  /// @return kCorrupt when the clock of a velocity, an attitude, a heading or a turn rate was set back
  Result<void> add(const NavLog& log);

  /// Solves for all that was added so far. May be called again after more was added.
  /// Without a velocity, motion is estimated from the sonar.
  /// @return kUnsupported naming what is missing: beams, a velocity or sweeps that match each other, a heading
  ///         wherever there are beams, or a time at which all were recorded;
  ///         kCorrupt when the times of the beams do not rise; kBadOption when a mounted source has no samples, or the
  ///         calibration is of another velocity
  Result<SlamSolution> solve() const;
  /// The same in a known map: echoes are matched with it instead of with each other. The mount of the sonar is fixed,
  /// and no heading needs to point to the map's north.
  /// @param near  poses in the map, within some decimetres and degrees, as a Localizer finds them; the solution is of
  ///              the beams within its time
  /// @return as solve(); kUnsupported also without a velocity
  Result<MapSolution> solve_in(const DistanceField& map, const Trajectory& near) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pingvox
