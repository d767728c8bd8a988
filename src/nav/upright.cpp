#include "nav/internal/upright.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "nav/plausible_values.hpp"
#include "nav/turn_checks.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kMinAttitudes = 10;

/// How far z of the body leans from z of the world, as a cosine.
double cosine_of_tilt(const Eigen::Vector3d& rpy) {
  return std::cos(rpy.x()) * std::cos(rpy.y());
}

}  // namespace

std::string doubt_of_attitudes(std::span<const Eigen::Vector3d> rpy) {
  constexpr double kNearlyAll = 0.95, kSteady_rad = 0.35, kVerySteady_rad = 0.05, kRolledOver_rad = 2.0,
                   kRolled_rad = 1.2;
  constexpr std::string_view kReasons =
      "is that how it moved, or how the sensor is mounted, or are quaternions in the order w x y z?";
  if (rpy.size() < kMinAttitudes) return {};
  const auto nearly_all_tilt_beyond = [&](double tilt_rad) {
    const auto beyond = std::ranges::count_if(
        rpy, [&](const Eigen::Vector3d& one) { return cosine_of_tilt(one) < std::cos(tilt_rad); });
    return static_cast<double>(beyond) >= kNearlyAll * static_cast<double>(rpy.size());
  };
  if (nearly_all_tilt_beyond(90.0 * kDegree_rad)) {
    return fmt::format("the vehicle is upside down all the time: {}", kReasons);
  }
  if (nearly_all_tilt_beyond(45.0 * kDegree_rad)) {
    return fmt::format("the vehicle lies on its side, or stands on end, all the time: {}", kReasons);
  }
  Eigen::Vector3d least = rpy.front(), most = rpy.front();
  for (const Eigen::Vector3d& one : rpy) {
    least = least.cwiseMin(one);
    most = most.cwiseMax(one);
  }
  const Eigen::Vector3d changed_rad = most - least;
  const bool is_steady = std::max(-least.tail<2>().minCoeff(), most.tail<2>().maxCoeff()) <= kSteady_rad;
  const bool is_very_steady = changed_rad.tail<2>().maxCoeff() <= kVerySteady_rad;
  if (is_steady && changed_rad.x() >= (is_very_steady ? kRolled_rad : kRolledOver_rad)) {
    return fmt::format(
        "the vehicle rolls {}by {:.0f} degrees, and never turns or pitches: are quaternions in the order w x y z, or "
        "roll and yaw swapped?",
        changed_rad.x() >= kRolledOver_rad ? "over, " : "", changed_rad.x() / kDegree_rad);
  }
  return {};
}

std::vector<NavSource> sources_of_poses(const Trajectory& trajectory) {
  NavSource position{"poses", NavQuantity::kPosition, {}}, attitude{"poses", NavQuantity::kAttitude, {}};
  for (const StampedPose& pose : trajectory.poses()) {
    position.samples.push_back({.time_s = pose.time_s, .value = pose.map_from_body.translation()});
    attitude.samples.push_back({.time_s = pose.time_s, .value = rpy_of(pose.map_from_body.rotation())});
  }
  std::vector<NavSource> sources = {std::move(position), std::move(attitude)};
  for (NavSource& source : sources) check_values(source);
  compare_turns(sources);
  return sources;
}

}  // namespace pingvox
