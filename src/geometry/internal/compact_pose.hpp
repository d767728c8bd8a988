#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>

#include "pingvox/geometry/trajectory.hpp"

namespace pingvox {

/// A pose at a time, or that it is not known, to the bit. 104 bytes instead of the 144 of a StampedPose and the 176 of
/// one with an optional pose: without the bottom row of the matrix, and not aligned. For lists with a pose of each beam
/// of a day.
class CompactPose {
 public:
  CompactPose(double pose_time_s, const std::optional<Pose>& pose) : time_s(pose_time_s) { set(pose); }
  explicit CompactPose(const StampedPose& pose) : CompactPose(pose.time_s, pose.map_from_body) {}

  std::optional<Pose> pose() const {
    if (std::isnan(rows_(0, 0))) return std::nullopt;
    Pose pose = Pose::Identity();
    pose.affine() = rows_;
    return pose;
  }
  /// REQUIRES a known pose.
  StampedPose stamped() const { return {time_s, *pose()}; }

  void set(const std::optional<Pose>& pose) {
    if (pose) {
      rows_ = pose->affine();
    } else {
      rows_(0, 0) = std::numeric_limits<double>::quiet_NaN();
    }
  }

  double time_s;

 private:
  Eigen::Matrix<double, 3, 4, Eigen::DontAlign> rows_ = Eigen::Matrix<double, 3, 4, Eigen::DontAlign>::Zero();
};

}  // namespace pingvox
