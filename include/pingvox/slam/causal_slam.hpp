#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/slam/slam_smoother.hpp"

namespace pingvox {

/// The sources of a vehicle's motion.
struct MotionReport {
  std::string velocity, heading;    ///< names of the sources, of the headings that of the main one
  bool by_sonar = false;            ///< the velocity is not measured: sweeps are matched with those before
  double deviation_m_sqrt_s = 0.0;  ///< standard deviation of the displacement after one second [m / sqrt(s)]
};

/// A pose and its uncertainty.
struct PredictedPose {
  StampedPose pose;
  double without_velocity_s = 0.0;  ///< since the last measured velocity; 0 where motion is from the sonar alone
  double deviation_m = 0.0;         ///< standard deviation of the displacement since the last solution
};

/// The pose of a vehicle on board: from the data until then, navigation until its next sample. After every other sweep
/// a window of the last ones is estimated again (SlamOptions::causal_sweeps), so that the work for a sweep and the
/// memory, apart from a pose for each beam, do not grow with time. In between, poses are predicted from velocity and
/// headings. CausalReplay runs it on a recording.
///
///     CausalSlam slam(options);
///     slam.add("dvl", NavQuantity::kVelocity, sample);  // as they come
///     slam.add(beam);
///     if (const auto pose = slam.pose()) steer_by(*pose);
class CausalSlam {
 public:
  /// REQUIRES valid options.
  explicit CausalSlam(const SlamOptions& options);
  ~CausalSlam();
  CausalSlam(CausalSlam&&) noexcept;
  CausalSlam& operator=(CausalSlam&&) noexcept;

  /// Takes the next beam, which must be valid; the last one of some sweeps leads to a solution. What is missing for one
  /// may come later.
  /// @return kCorrupt when its time is before that of the last one, or their times jump; kUnsupported when what was
  /// recorded does not determine the poses (any more). No more beams can be added then
  Result<void> add(Beam beam);
  /// Takes a sample of a source; see SlamSmoother::add.
  Result<void> add(std::string_view source, NavQuantity quantity, const NavSample& sample);

  /// The last known pose: where both velocity and heading were measured last, by the last solution and dead reckoning
  /// since; without a velocity, by the motion that is estimated from the sonar, extrapolated from the last sweep. The
  /// first pose is at 0, 0. nullopt: before the first solution, and while motion is not observable in the sonar alone.
  /// @param until_s  if more is known, the pose at this time, but of a time that was solved already the last one
  std::optional<StampedPose> pose(double until_s = std::numeric_limits<double>::infinity()) const;

  /// As `pose`, but where the velocity is missing at the end the vehicle is assumed to keep the last one in its own
  /// frame, along the headings: the standard deviation grows. The next solution uses matches of sweeps there.
  std::optional<PredictedPose> predict(double until_s) const;

  /// The path as it is estimated now, in the frame of the poses: at each beam until the last solution, by that one
  /// where the beam is in its window, else as the beam left the window. After loops it is better than the
  /// predicted poses. Where these pause it has gaps. nullopt: before the first solution.
  std::optional<Trajectory> path() const;
  /// The part of the path that the last solution has estimated; empty: before the first one.
  std::vector<StampedPose> newest_path() const;
  std::size_t solutions() const;  ///< so far
  LoopCount loops() const;        ///< as SlamReport::pairs.submap_loops, so far
  /// By the last solution; nullopt: before the first one.
  std::optional<MotionReport> motion() const;

  /// Ends the recording: the poses of all beams, each from what was known then. The report's check of the velocity is
  /// that of the last sweeps. Nothing can be added afterwards, and `pose` is not known any more; the path is.
  /// @return errors of SlamSmoother::solve
  Result<SlamSolution> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pingvox
