#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/map/distance_field.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/localizer.hpp"
#include "pingvox/slam/odometry.hpp"
#include "pingvox/slam/slam_smoother.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Where a vehicle begins in the map, with standard deviations of x, of y, and of the yaw.
struct StartPose {
  double x_m = 0.0, y_m = 0.0, yaw_rad = 0.0;
  double deviation_m = 0.5, deviation_rad = 10.0 * kDegree_rad;
};

/// The known motion of a vehicle while the beams were recorded.
struct RecordedMotion {
  std::optional<Trajectory> odometry_from_body;  ///< in a frame that may drift; nullopt: unknown
  /// What the odometry was computed from, with a velocity. nullopt: poses are those of the filter.
  std::optional<NavLog> nav;
  OdometryOptions nav_options;  ///< of `nav`
};

/// What the pose of a beam is estimated from.
enum class Estimation {
  kBatch,   ///< all that was recorded
  kCausal,  ///< what was recorded until then, as on board
};

struct LocateOptions {
  LocalizerOptions localizer;
  std::optional<StartPose> start = std::nullopt;  ///< nullopt: anywhere
  Estimation estimation = Estimation::kBatch;     ///< kBatch: where there is `RecordedMotion::nav`, poses by all of it
};

/// A pose in the map and its status.
struct LocatedPose {
  double time_s = 0.0;  ///< of a beam
  Pose map_from_body = Pose::Identity();
  bool was_sure = false;     ///< by the beams until then (Localizer::is_sure)
  bool is_smoothed = false;  ///< estimated from all of the recording
  bool is_known = false;     ///< known to be right; else it is the most likely of several, or does not fit
};

struct LocatedRecording {
  std::vector<LocatedPose> poses;          ///< not empty; of each beam since the vehicle was found first
  std::vector<PoseHypothesis> hypotheses;  ///< at the end, the most likely first
  /// Error of the times of the odometry (clock_error). nullopt: no odometry, or not observable.
  std::optional<ClockOffset> clock_check;
  double mean_particles = 0.0;
  std::size_t most_particles = 0;

  bool is_sure() const { return poses.back().was_sure; }  ///< at the end
  /// Poses as a trajectory.
  Result<Trajectory> trajectory() const;
  /// The poses that are known to be right, with gaps between them. nullopt: none.
  std::optional<Trajectory> known_trajectory() const;
};

/// Where a vehicle was in a known map, from a whole recording: a Localizer's filter and, where velocities and headings
/// are known, SlamSmoother::solve_in over all poses, or else over each segment between jumps, as far as the map fits
/// (docs/locate.md).
/// @param beams     not empty, valid, in order of time
/// @param progress  called with the share that is done, in 0..1
/// @return kUnsupported when no echo fits anywhere in the map; kCorrupt when times are not in order, or the clock of
///         the navigation was set back; kBadOption when a mount is of no source, or the calibration of another velocity
Result<LocatedRecording> locate_recording(std::vector<Beam> beams, const RecordedMotion& motion,
                                          const DistanceField& map, const LocateOptions& options,
                                          const std::function<void(double)>& progress = nullptr);

}  // namespace pingvox
