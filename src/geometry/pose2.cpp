#include "pingvox/geometry/pose2.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>

namespace pingvox {

Pose2 fit_pose2(std::span<const Eigen::Vector2d> points_m, std::span<const Eigen::Vector2d> others_m) {
  assert(!points_m.empty() && points_m.size() == others_m.size());
  const auto count = static_cast<double>(points_m.size());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero(), mean_of_others = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    mean += points_m[i] / count;
    mean_of_others += others_m[i] / count;
  }
  double cosine = 0.0, sine = 0.0;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector2d a = points_m[i] - mean, b = others_m[i] - mean_of_others;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const double yaw_rad = std::atan2(sine, cosine);
  return {mean_of_others - rotation2(yaw_rad) * mean, yaw_rad};
}

}  // namespace pingvox
