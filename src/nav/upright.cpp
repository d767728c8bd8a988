#include "nav/internal/upright.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kFewest = 10;

/// Whether z of the body points down.
bool is_upside_down(const Eigen::Vector3d& rpy) {
  return std::cos(rpy.x()) * std::cos(rpy.y()) < 0.0;
}

}  // namespace

std::string doubt_of_attitudes(std::span<const Eigen::Vector3d> rpy) {
  constexpr double kNearlyAll = 0.95, kSteady_rad = 0.35, kRolledOver_rad = 2.0;
  if (rpy.size() < kFewest) return {};
  const auto upside_down = static_cast<double>(std::ranges::count_if(rpy, is_upside_down));
  if (upside_down >= kNearlyAll * static_cast<double>(rpy.size())) {
    return "the vehicle is upside down all the time: is that how it moved, or how the sensor is mounted, or are "
           "quaternions in the order w x y z?";
  }
  const auto [least, most] = std::ranges::minmax(rpy, {}, [](const Eigen::Vector3d& one) { return one.x(); });
  const double rolled_rad = most.x() - least.x();
  const bool is_steady = std::ranges::all_of(
      rpy, [&](const Eigen::Vector3d& one) { return one.tail<2>().cwiseAbs().maxCoeff() <= kSteady_rad; });
  if (is_steady && rolled_rad >= kRolledOver_rad) {
    return fmt::format(
        "the vehicle rolls over, by {:.0f} degrees, and never turns or pitches: are quaternions in the "
        "order w x y z?",
        rolled_rad / kDegree_rad);
  }
  return {};
}

std::string doubt_of_poses(const Trajectory& trajectory) {
  std::vector<Eigen::Vector3d> rpy;
  rpy.reserve(trajectory.poses().size());
  for (const StampedPose& pose : trajectory.poses()) rpy.push_back(rpy_of(pose.map_from_body.rotation()));
  return doubt_of_attitudes(rpy);
}

}  // namespace pingvox
