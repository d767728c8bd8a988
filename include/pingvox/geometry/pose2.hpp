#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <span>

#include "pingvox/geometry/pose.hpp"

namespace pingvox {

/// An angle [rad] wrapped to (-pi, pi], within rounding.
inline double wrap_angle(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

inline Eigen::Matrix2d rotation2(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

inline Eigen::Vector2d quarter_turn(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

/// A pose in the plane: to_from, as Pose.
struct Pose2 {
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;

  Pose2 inverse() const { return {-(rotation2(-yaw_rad) * place_m), -yaw_rad}; }
  Pose2 operator*(const Pose2& other) const {
    return {place_m + rotation2(yaw_rad) * other.place_m, wrap_angle(yaw_rad + other.yaw_rad)};
  }
  Eigen::Vector2d operator*(const Eigen::Vector2d& point_m) const { return place_m + rotation2(yaw_rad) * point_m; }
};

/// The yaw of rpy_of [rad].
inline double yaw_of(const Eigen::Matrix3d& rotation) {
  return std::atan2(rotation(1, 0), rotation(0, 0));
}
inline double yaw_of(const Pose& pose) {
  return yaw_of(pose.linear());
}

/// Position and yaw of a pose, seen from above.
inline Pose2 pose2_of(const Pose& pose) {
  return {pose.translation().head<2>(), yaw_of(pose)};
}

/// The turn and move that bring points nearest to others in the mean square. REQUIRES as many others, at least one.
Pose2 fit_pose2(std::span<const Eigen::Vector2d> points_m, std::span<const Eigen::Vector2d> others_m);

}  // namespace pingvox
