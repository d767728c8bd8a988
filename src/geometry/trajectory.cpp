#include "pingvox/geometry/trajectory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pingvox {

Trajectory Trajectory::still(const Pose& map_from_body, double time_s) {
  return Trajectory({{time_s, map_from_body}}, std::numeric_limits<double>::infinity(), {}, true);
}

Result<Trajectory> Trajectory::make(std::vector<StampedPose> poses, double longest_step_s,
                                    std::vector<std::size_t> cuts) {
  if (poses.empty()) return fail(Error::Code::kCorrupt, "a trajectory needs at least one pose");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!std::isfinite(poses[i].time_s) || !poses[i].map_from_body.matrix().allFinite()) {
      return fail(Error::Code::kCorrupt, fmt::format("pose {} is not finite", i));
    }
    if (i > 0 && !(poses[i].time_s > poses[i - 1].time_s)) {
      return fail(Error::Code::kCorrupt,
                  fmt::format("pose {}: time {} s does not follow {} s", i, poses[i].time_s, poses[i - 1].time_s));
    }
  }
  std::size_t least = 1;
  for (const std::size_t cut : cuts) {
    if (cut < least || cut >= poses.size()) {
      return fail(Error::Code::kCorrupt, fmt::format("a cut before pose {} of {}", cut, poses.size()));
    }
    least = cut + 1;
  }
  return Trajectory(std::move(poses), longest_step_s, std::move(cuts), false);
}

std::optional<Pose> Trajectory::at(double time_s) const {
  if (still_) return poses_.front().map_from_body;
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), time_s,
                                      [](const StampedPose& pose, double t) { return pose.time_s < t; });
  if (after == poses_.end() || std::isnan(time_s)) return std::nullopt;
  if (after->time_s == time_s) return after->map_from_body;
  if (after == poses_.begin()) return std::nullopt;
  if (is_gap(static_cast<std::size_t>(after - poses_.begin()))) return std::nullopt;
  const auto before = std::prev(after);
  return interpolate(before->map_from_body, after->map_from_body,
                     (time_s - before->time_s) / (after->time_s - before->time_s));
}

/// Between this pose and the one before it.
bool Trajectory::is_gap(std::size_t after) const {
  return poses_[after].time_s - poses_[after - 1].time_s > longest_step_s_ || std::ranges::binary_search(cuts_, after);
}

std::size_t Trajectory::gaps() const {
  std::size_t count = 0;
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    if (is_gap(i)) ++count;
  }
  return count;
}

}  // namespace pingvox
