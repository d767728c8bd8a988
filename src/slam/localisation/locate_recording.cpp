#include "pingvox/slam/locate_recording.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>

#include "base/without_exceptions.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "slam/internal/picture_turns.hpp"
#include "slam/odometry/trajectory_gaps.hpp"
#include "slam/sweeps/level_head.hpp"

namespace pingvox {
namespace {

using Poses = std::span<LocatedPose>;

std::vector<StampedPose> poses_of(std::span<const LocatedPose> poses) {
  std::vector<StampedPose> all;
  all.reserve(poses.size());
  for (const LocatedPose& pose : poses) all.push_back({pose.time_s, pose.map_from_body});
  return all;
}

SlamOptions smoother_options(const OdometryOptions& nav, const LocalizerOptions& localizer) {
  SlamOptions options;
  options.seed = localizer.seed;
  options.body_from_sonar = localizer.body_from_sonar;
  options.body_from_source = nav.body_from_source;
  options.nav_offset_s = nav.offset_s;
  options.calibration = nav.calibration;
  options.filter = localizer.filter;
  options.sound_speed_ratio = localizer.sound_speed_ratio;
  options.echo = localizer.echo;
  return options;
}

/// nullopt: poses are those of the filter.
Result<std::optional<SlamSmoother>> smoother_of(const RecordedMotion& motion, const LocateOptions& options) {
  if (options.estimation == Estimation::kCausal || !motion.nav) return std::nullopt;
  if (!is_level(options.localizer.body_from_sonar)) return std::nullopt;
  SlamSmoother smoother(smoother_options(motion.nav_options, options.localizer));
  if (const auto added = smoother.add(*motion.nav); !added) return tl::unexpected(added.error());
  return std::optional(std::move(smoother));
}

/// Where the poses jump or turn at once, as when the vehicle was carried away or was lost and is found.
std::vector<Poses> segments_of(Poses poses) {
  constexpr double kJump_m = 0.5, kFastest_m_s = 2.0;
  constexpr double kTurn_rad = 20.0 * kDegree_rad, kFastest_rad_s = 90.0 * kDegree_rad;
  const auto follows = [&](const LocatedPose& before, const LocatedPose& pose) {
    const double step_s = pose.time_s - before.time_s;
    const Pose &from = before.map_from_body, &to = pose.map_from_body;
    const double turn_rad = yaw_of(from.rotation().transpose() * to.rotation());
    return (to.translation() - from.translation()).head<2>().norm() <= kJump_m + kFastest_m_s * step_s &&
           std::abs(turn_rad) <= kTurn_rad + kFastest_rad_s * step_s;
  };
  std::vector<Poses> segments;
  std::size_t first = 0;
  for (std::size_t i = 1; i <= poses.size(); ++i) {
    if (i < poses.size() && follows(poses[i - 1], poses[i])) continue;
    segments.push_back(poses.subspan(first, i - first));
    first = i;
  }
  return segments;
}

/// Replaces poses by those of all of the recording where the map fits. False: it does not.
Result<bool> smooth(const SlamSmoother& smoother, const DistanceField& map, Poses poses) {
  const Result<Trajectory> near = Trajectory::make(poses_of(poses));
  if (!near) return false;
  const Result<MapSolution> solution = smoother.solve_in(map, *near);
  if (!solution && solution.error().code == Error::Code::kUnsupported) return false;
  if (!solution) return tl::unexpected(solution.error());
  for (LocatedPose& pose : poses) {
    const auto better = solution->trajectory.at(pose.time_s);
    if (!better) continue;
    pose.map_from_body = *better;
    pose.is_smoothed = true;
  }
  return true;
}

/// Smooths all poses at once, or else each segment. @return whether the map fits all the time
Result<bool> smooth_all(const SlamSmoother& smoother, const DistanceField& map, Poses poses,
                        std::vector<Poses>& segments) {
  Result<bool> fits = smooth(smoother, map, poses);
  if (!fits) return fits;
  if (*fits) segments = {poses};
  if (segments.size() == 1) return fits;
  for (const Poses segment : segments) {
    if (const auto done = smooth(smoother, map, segment); !done) return tl::unexpected(done.error());
  }
  return fits;
}

/// Marks the poses that are known once all is recorded: in a segment those until the last one that was sure, and after
/// it where the map fits.
/// @param doubt_s  before the last one that was sure; 0: the segment is the last one
void mark_known(Poses segment, double doubt_s) {
  std::size_t sure_end = segment.size();
  while (sure_end > 0 && !segment[sure_end - 1].was_sure) --sure_end;
  if (sure_end == 0) return;
  const double doubt_from_s = segment[sure_end - 1].time_s - doubt_s;
  for (std::size_t i = 0; i < segment.size(); ++i) {
    segment[i].is_known = doubt_s > 0.0 ? segment[i].time_s < doubt_from_s : i < sure_end || segment[i].is_smoothed;
  }
}

/// The time in which the head turns once.
double turn_s(std::span<const Beam> beams) {
  double turned_rad = 0.0;
  for (std::size_t i = 1; i < beams.size(); ++i) {
    turned_rad += std::abs(wrap_angle(beams[i].bearing_rad - beams[i - 1].bearing_rad));
  }
  return (beams.back().time_s - beams.front().time_s) * 2.0 * std::numbers::pi / turned_rad;
}

/// A filter's pose after a beam.
void note(const Localizer& localizer, double time_s, std::vector<LocatedPose>& poses) {
  const std::optional<Localizer::Located> located = localizer.pose();
  if (!located) return;
  if (!poses.empty() && poses.back().time_s >= time_s) poses.pop_back();
  poses.push_back({.time_s = time_s, .map_from_body = located->map_from_body, .was_sure = localizer.is_sure()});
}

}  // namespace

Result<Trajectory> LocatedRecording::trajectory() const {
  return trajectory_with_gaps(poses_of(poses));
}

std::optional<Trajectory> LocatedRecording::known_trajectory() const {
  std::vector<StampedPose> known;
  for (const LocatedPose& pose : poses) {
    if (pose.is_known) known.push_back({pose.time_s, pose.map_from_body});
  }
  if (known.empty()) return std::nullopt;
  Result<Trajectory> trajectory = trajectory_with_gaps(std::move(known));
  return trajectory ? std::optional(*std::move(trajectory)) : std::nullopt;
}

Result<LocatedRecording> locate_recording(std::vector<Beam> beams, const RecordedMotion& motion,
                                          const DistanceField& map, const LocateOptions& options,
                                          const std::function<void(double)>& progress) {
  return detail::without_exceptions([&]() -> Result<LocatedRecording> {
    assert(!beams.empty());
    Localizer localizer(map, options.localizer);
    if (const auto& start = options.start) {
      localizer.start(start->x_m, start->y_m, start->yaw_rad, start->deviation_m, start->deviation_rad);
    }
    Result<std::optional<SlamSmoother>> smoother = smoother_of(motion, options);
    if (!smoother) return tl::unexpected(smoother.error());

    LocatedRecording found;
    PictureTurns turns(options.localizer.body_from_sonar);
    const auto count = static_cast<double>(beams.size());
    const double end_s = beams.back().time_s;
    // Where the vehicle was carried away the filter becomes unsure within a turn of the head.
    const double doubt_s = turn_s(beams);
    for (std::size_t i = 0; i < beams.size(); ++i) {
      if (progress) progress(static_cast<double>(i) / count);
      const double time_s = beams[i].time_s;
      if (*smoother) (*smoother)->add(beams[i]);
      const auto& odometry = motion.odometry_from_body;
      if (odometry) turns.add(beams[i]);
      if (const auto pose = odometry ? odometry->at(time_s) : std::nullopt) localizer.add({time_s, *pose});
      if (const auto added = localizer.add(std::move(beams[i])); !added) return tl::unexpected(added.error());
      note(localizer, time_s, found.poses);
      found.mean_particles += static_cast<double>(localizer.particles()) / count;
      found.most_particles = std::max(found.most_particles, localizer.particles());
    }
    localizer.finish();
    note(localizer, end_s, found.poses);
    if (found.poses.empty()) return fail(Error::Code::kUnsupported, "no echo fits anywhere in the map");
    found.hypotheses = localizer.hypotheses();
    if (motion.odometry_from_body) {
      const std::vector<YawChange> changes = turns.finish();
      found.clock_check = clock_error(changes, turns.pauses(), *motion.odometry_from_body);
    }
    if (options.estimation == Estimation::kCausal) {
      for (LocatedPose& pose : found.poses) pose.is_known = pose.was_sure;
      return found;
    }

    std::vector<Poses> segments = segments_of(found.poses);
    Result<bool> fits = false;
    if (*smoother) fits = smooth_all(**smoother, map, found.poses, segments);
    if (!fits) return tl::unexpected(fits.error());
    for (const Poses& segment : segments) mark_known(segment, &segment == &segments.back() ? 0.0 : doubt_s);
    // One place is left, and the map fits there all the time. Before and after the navigation only the filter tells.
    if (*fits && !found.hypotheses.empty() && found.hypotheses.front().weight >= Localizer::kSureWeight) {
      for (LocatedPose& pose : found.poses) pose.is_known = pose.is_smoothed || pose.was_sure;
    }
    return found;
  });
}

}  // namespace pingvox
