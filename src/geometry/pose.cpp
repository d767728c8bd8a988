#include "pingvox/geometry/pose.hpp"

#include <algorithm>
#include <cmath>

namespace pingvox {

Pose pose_from_rpy(const Eigen::Vector3d& position_m, double roll_rad, double pitch_rad, double yaw_rad) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  Pose pose = Pose::Identity();
  pose.linear() = (AngleAxisd(yaw_rad, Vector3d::UnitZ()) * AngleAxisd(pitch_rad, Vector3d::UnitY()) *
                   AngleAxisd(roll_rad, Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = position_m;
  return pose;
}

Eigen::Vector3d rpy_of(const Eigen::Matrix3d& r) {
  return {std::atan2(r(2, 1), r(2, 2)), std::asin(std::clamp(-r(2, 0), -1.0, 1.0)), std::atan2(r(1, 0), r(0, 0))};
}

Pose interpolate(const Pose& a, const Pose& b, double share) {
  const Eigen::Quaterniond qa(a.linear()), qb(b.linear());
  Pose pose = Pose::Identity();
  pose.linear() = qa.slerp(share, qb).toRotationMatrix();
  pose.translation() = a.translation() + share * (b.translation() - a.translation());
  return pose;
}

}  // namespace pingvox
