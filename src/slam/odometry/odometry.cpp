#include "pingvox/slam/odometry.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "nav/internal/navigation.hpp"
#include "pingvox/geometry/pose2.hpp"
#include "slam/odometry/heading_deviation.hpp"

namespace pingvox {
namespace {

/// Sources that are silent for longer say nothing of the way in between.
constexpr double kMaxStep_s = 5.0;

/// Leaves out the times at which another source goes on while this one is silent.
void leave_out_gaps(const TimeSeries& series, std::vector<double>& times_s) {
  std::vector<TimeSpan> gaps = series.gaps(series.from_s(), series.to_s());
  std::erase_if(gaps, [](const TimeSpan& gap) { return gap.to_s - gap.from_s <= kMaxStep_s; });
  std::erase_if(times_s, [&](double time_s) {
    const auto next = std::ranges::lower_bound(gaps, time_s, {}, &TimeSpan::from_s);
    return next != gaps.begin() && time_s < std::prev(next)->to_s;
  });
}

Result<void> correct(const SlamCalibration& calibration, HeadingSource& heading,
                     std::optional<VelocitySource>& velocity) {
  const HeadingCalibration* deviation = calibration.heading(heading.name);
  if (deviation == nullptr) {
    return fail(Error::Code::kBadOption, fmt::format("the calibration has no heading of {}", heading.name));
  }
  // A device that is turned against its mount turns its heading, too.
  const double turned_rad = heading.name == calibration.velocity ? calibration.velocity_yaw_rad.value : 0.0;
  std::vector<double> yaw_rad = heading.yaw_rad.values();
  for (double& yaw : yaw_rad) yaw = yaw_of_heading(*deviation, yaw - turned_rad);
  heading.yaw_rad = TimeSeries(heading.yaw_rad.times_s(), std::move(yaw_rad));
  if (!velocity) return {};
  if (velocity->name != calibration.velocity) {
    return fail(Error::Code::kBadOption, fmt::format("the calibration is of the velocity of {}, not of {}",
                                                     calibration.velocity, velocity->name));
  }
  const Eigen::Matrix2d body_from_measured =
      (1.0 + calibration.velocity_scale.value) * rotation2(calibration.velocity_yaw_rad.value);
  std::vector<double> ahead = velocity->ahead.values(), left = velocity->left.values();
  for (std::size_t i = 0; i < ahead.size(); ++i) {
    const Eigen::Vector2d corrected = body_from_measured * Eigen::Vector2d(ahead[i], left[i]);
    ahead[i] = corrected.x();
    left[i] = corrected.y();
  }
  velocity->ahead = TimeSeries(velocity->ahead.times_s(), std::move(ahead));
  velocity->left = TimeSeries(velocity->left.times_s(), std::move(left));
  return {};
}

}  // namespace

Result<Odometry> odometry_of(const NavLog& log, const OdometryOptions& options) {
  if (const auto checked = check_sources(log, kReckoningQuantities); !checked) return tl::unexpected(checked.error());
  if (const auto known = check_mounts(log, options.body_from_source); !known) return tl::unexpected(known.error());
  const NavSource* const moves = log.best(NavQuantity::kVelocity);
  std::optional<HeadingSource> heading = best_heading(log, options.body_from_source, moves);
  if (!heading) return fail(Error::Code::kUnsupported, "the navigation has no valid heading or attitude");
  std::optional<VelocitySource> velocity;
  if (moves != nullptr) velocity = velocity_source(*moves, mount_of(options.body_from_source, moves->name));
  if (options.calibration) {
    if (const auto done = correct(*options.calibration, *heading, velocity); !done) return tl::unexpected(done.error());
  }
  const NavSource* rate = options.turns == TurnsBy::kTurnRate ? log.best(NavQuantity::kTurnRate) : nullptr;
  if (rate != nullptr) {
    if (auto turned = gyro_heading(*rate, mount_of(options.body_from_source, rate->name), *heading)) {
      turned->name = heading->name;
      heading = std::move(turned);
    }
  }
  std::optional<TimeSeries> depth;
  if (const auto source = depth_source(log)) {
    if (const auto checked = check_source(*source); !checked) return tl::unexpected(checked.error());
    depth = number_source(*source);
  }

  double from_s = heading->yaw_rad.from_s(), to_s = heading->yaw_rad.to_s();
  std::vector<double> times_s = heading->yaw_rad.times_s();
  if (velocity) {
    from_s = std::max(from_s, velocity->ahead.from_s());
    to_s = std::min(to_s, velocity->ahead.to_s());
    if (!(from_s < to_s)) {
      return fail(Error::Code::kUnsupported,
                  fmt::format("the velocity of {} and the heading of {} do not overlap in time", velocity->name,
                              heading->name));
    }
    times_s.insert(times_s.end(), velocity->ahead.times_s().begin(), velocity->ahead.times_s().end());
  }
  std::ranges::sort(times_s);
  times_s.erase(std::ranges::unique(times_s).begin(), times_s.end());
  std::erase_if(times_s, [&](double time_s) { return time_s < from_s || time_s > to_s; });
  leave_out_gaps(heading->yaw_rad, times_s);
  if (velocity) leave_out_gaps(velocity->ahead, times_s);

  // What is measured at a place of the body is carried to its origin.
  const Eigen::Vector3d place = velocity ? mount_of(options.body_from_source, velocity->name).translation()
                                         : Eigen::Vector3d(Eigen::Vector3d::Zero());
  std::vector<StampedPose> poses;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const double time_s = times_s[i];
    if (velocity && i > 0) {
      const double middle_s = 0.5 * (times_s[i - 1] + time_s), step_s = time_s - times_s[i - 1];
      const double yaw = heading->yaw_rad.at(middle_s);
      const double ahead_m = step_s * velocity->ahead.at(middle_s), left_m = step_s * velocity->left.at(middle_s);
      at += Eigen::Vector2d(std::cos(yaw) * ahead_m - std::sin(yaw) * left_m,
                            std::sin(yaw) * ahead_m + std::cos(yaw) * left_m);
    }
    Pose pose = pose_from_rpy({at.x(), at.y(), depth ? -depth->at(time_s) : 0.0},
                              heading->roll_rad ? heading->roll_rad->at(time_s) : 0.0,
                              heading->pitch_rad ? heading->pitch_rad->at(time_s) : 0.0, heading->yaw_rad.at(time_s));
    pose.translation().head<2>() -= (pose.rotation() * place).head<2>();
    poses.push_back({time_s + options.offset_s, pose});
  }
  const Eigen::Vector2d origin = poses.front().map_from_body.translation().head<2>();
  for (StampedPose& pose : poses) pose.map_from_body.translation().head<2>() -= origin;
  Result<Trajectory> trajectory = Trajectory::make(std::move(poses), kMaxStep_s);
  if (!trajectory) return tl::unexpected(trajectory.error());
  return Odometry{*std::move(trajectory), heading->name, velocity ? velocity->name : std::string()};
}

}  // namespace pingvox
