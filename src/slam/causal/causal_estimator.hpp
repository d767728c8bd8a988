#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/internal/compact_pose.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/causal_slam.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "slam/causal/causal_window.hpp"
#include "slam/odometry/sonar_odometry.hpp"
#include "slam/smoother/slam_input.hpp"
#include "slam/smoother/sweep_loops.hpp"

namespace pingvox {

/// Outliers of a velocity are judged by as many samples as else, but earlier ones.
inline constexpr OutlierWindow kEarlierSamples = {10, 0};

/// Estimates each pose from what was recorded until then: after every kSweepsOfStep sweeps the poses of their beams by
/// dead reckoning from the last solution, then a new solution of a window of the last sweeps.
class CausalEstimator {
 public:
  /// REQUIRES valid options.
  explicit CausalEstimator(SlamOptions options);
  // Solutions point to the window.
  CausalEstimator(const CausalEstimator&) = delete;
  CausalEstimator& operator=(const CausalEstimator&) = delete;

  /// @param time_s  not before that of the last one
  void add_beam(double time_s);
  /// Takes a sweep that is followed by another one, and whose beams were added; the last one of a step leads to a
  /// solution, with navigation until its end. What is missing for one may come later.
  /// @return kUnsupported when the recording does not determine the poses, which are as before then: these sweeps are
  ///         solved with the next ones; kCorrupt when times jump
  Result<void> add_sweep(SweepEchoes sweep);
  /// Takes a sample on the clock of the navigation. @return kCorrupt when a number is not finite
  Result<void> add_sample(std::string_view source, NavQuantity quantity, const NavSample& sample);

  /// @see CausalSlam::pose
  std::optional<StampedPose> pose(double until_s) const;
  /// @see CausalSlam::predict
  std::optional<PredictedPose> predict(double until_s) const;
  /// @see CausalSlam::path
  std::vector<StampedPose> path() const;
  /// @see CausalSlam::newest_path
  std::vector<StampedPose> newest_path() const;
  /// @see CausalSlam::motion
  std::optional<MotionReport> motion() const;
  std::size_t solutions() const { return solutions_; }
  const SweepLoops& loops() const { return loops_; }
  /// Solves with the last sweep, if there is one, and all navigation.
  Result<SlamSolution> finish(std::optional<SweepEchoes> last);

 private:
  /// Until when the last pose goes on.
  enum class Until {
    kMeasured,  ///< velocity and heading were measured last
    kHeading,   ///< a heading was measured last
  };
  std::optional<PredictedPose> pose_until(double until_s, Until until) const;
  void take(SweepEchoes sweep);
  Result<void> solve_until(double nav_until_s);
  /// Navigation of the window and of the time before that it needs, with MotionSource::kSonar also how the vehicle
  /// moved.
  MotionSources sources_of_window(double nav_until_s);
  /// Fills gaps of the velocity from the sonar, also at the end, once there is a trajectory.
  void fill_gaps(Navigation& navigation);
  /// Of the beams since the last solution, by what a new one begins with.
  std::vector<StampedPose> new_poses(const SlamSolver& solver, const SlamInput& recording) const;
  Result<void> not_determined();
  void forget();
  /// Whether enough of all sweeps match, where the vehicle moves by its sonar.
  bool is_observable() const;
  Pose in_frame(const Pose& pose) const;
  /// Of these beams, by the last solution. REQUIRES that there is one.
  std::vector<StampedPose> solved_poses(std::span<const double> times_s) const;
  /// Poses of those that left the window from the first one on, then those of the window, from the origin of the told
  /// poses.
  std::vector<StampedPose> path_from(std::size_t first) const;

  SlamOptions options_;
  /// Of the window, and what waits.
  std::vector<double> beam_times_s_;
  std::vector<SweepEchoes> sweeps_;
  std::vector<NavSource> sources_;  ///< with some samples before, in order
  std::size_t beams_ = 0, all_sweeps_ = 0, complete_sweeps_ = 0;
  std::size_t sweeps_of_step_ = 0;  ///< since the last solution

  GrowingOdometry odometry_;

  CausalWindow window_;
  SweepLoops loops_;                  ///< that moved the poses, of all solutions
  std::optional<SlamSolver> solver_;  ///< of the last solution
  Error missing_{};                   ///< why there is no later one
  double filled_s_ = 0.0,
         filled_until_s_ = -kInfinity;       ///< where the velocity was missing and estimated from the sonar
  std::deque<CompactPose> poses_;            ///< on board, of all beams
  std::optional<Eigen::Vector2d> origin_m_;  ///< where the first of them is
  std::optional<TimeSeries> depth_;          ///< of the last solution
  std::size_t solutions_ = 0;
  std::deque<CompactPose> left_;  ///< of the beams that left the window, as it had them last
  std::size_t first_newest_ = 0;  ///< of these, the first one that the last solution had in its window
  /// Later solutions turn the whole trajectory as they learn how the compasses deviate. The poses go on in the frame of
  /// those before, or their map would bend. What left the window keeps its frame.
  Pose2 frame_;
};

}  // namespace pingvox
