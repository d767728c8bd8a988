#include "live/map_locator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pingvox/map/distance_field.hpp"

namespace pingvox {
namespace {

/// Turned about the vertical and moved along the plane.
Pose pose_of_plane(const Pose2& pose) {
  return pose_from_rpy({pose.place_m.x(), pose.place_m.y(), 0.0}, 0.0, 0.0, pose.yaw_rad);
}

/// The pose at just this time; nullptr: there is none.
const StampedPose* pose_of_time(std::span<const StampedPose> poses, double time_s) {
  const auto found = std::ranges::lower_bound(poses, time_s, {}, &StampedPose::time_s);
  return found != poses.end() && found->time_s == time_s ? &*found : nullptr;
}

}  // namespace

void MapLocator::add(const Beam& beam) {
  constexpr std::size_t kMaxWaiting = 2000;
  waiting_.push_back(beam);
  if (waiting_.size() > kMaxWaiting) waiting_.pop_front();
}

/// In the layer of the map around the sonar.
Result<void> MapLocator::begin(const Pose& first, const OccupancyMap& map) {
  constexpr double kHalf_m = 0.5;
  const double z_m = (first * options_.body_from_sonar.translation()).z();
  Result<DistanceField> field = DistanceField::make(map, {z_m - kHalf_m, z_m + kHalf_m});
  if (!field) return tl::unexpected(field.error());
  localizer_.emplace(*std::move(field), options_);
  if (start_) localizer_->start(start_->x_m, start_->y_m, start_->yaw_rad, start_->deviation_m, start_->deviation_rad);
  return {};
}

Result<std::optional<MapLocator::Located>> MapLocator::update(std::span<const StampedPose> newest,
                                                              const OccupancyMap& map) {
  ++solutions_;
  if (!localizer_) {
    if (const auto begun = begin(newest.front().map_from_body, map); !begun) return tl::unexpected(begun.error());
  }
  if (const StampedPose* const moved = last_ ? pose_of_time(newest, last_->time_s) : nullptr) {
    odometry_from_slam_ = pose2_of(last_->map_from_body) * pose2_of(moved->map_from_body).inverse();
  }
  const Pose odometry_from_slam = pose_of_plane(odometry_from_slam_);
  std::size_t beams = 0, sure = 0;
  double sin_sum = 0.0, cos_sum = 0.0;
  Eigen::Vector2d slam_sum_m = Eigen::Vector2d::Zero(), map_sum_m = Eigen::Vector2d::Zero();
  for (; !waiting_.empty() && waiting_.front().time_s <= newest.back().time_s; waiting_.pop_front()) {
    const StampedPose* const pose = pose_of_time(newest, waiting_.front().time_s);
    if (pose != nullptr) {
      last_ = {pose->time_s, odometry_from_slam * pose->map_from_body};
      localizer_->add(*last_);
    }
    if (const auto added = localizer_->add(std::move(waiting_.front())); !added) return tl::unexpected(added.error());
    ++beams;
    const auto located = localizer_->is_sure() ? localizer_->pose() : std::nullopt;
    if (!located || pose == nullptr) continue;
    const Pose2 by_slam = pose2_of(pose->map_from_body), by_map = pose2_of(located->map_from_body);
    ++sure;
    sin_sum += std::sin(by_map.yaw_rad - by_slam.yaw_rad);
    cos_sum += std::cos(by_map.yaw_rad - by_slam.yaw_rad);
    slam_sum_m += by_slam.place_m;
    map_sum_m += by_map.place_m;
  }
  // A mean over a sweep, half of what a solution adds: a single pose of the particles is off by their noise.
  if (sure == 0 || 2 * sure < beams || !localizer_->is_sure()) return std::nullopt;
  const auto count = static_cast<double>(sure);
  const double yaw_rad = std::atan2(sin_sum, cos_sum);
  const Eigen::Vector2d place_m = map_sum_m / count - rotation2(yaw_rad) * (slam_sum_m / count);
  return Located{{place_m, yaw_rad}, localizer_->hypotheses().front()};
}

std::vector<PoseHypothesis> MapLocator::hypotheses() const {
  return localizer_ ? localizer_->hypotheses() : std::vector<PoseHypothesis>{};
}

}  // namespace pingvox
