#pragma once

#include <optional>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

struct StampedPose {
  double time_s = 0.0;
  Pose map_from_body = Pose::Identity();
};

/// Where the vehicle was: poses in order of time, read between them by interpolation. Never empty.
class Trajectory {
 public:
  /// Stands still at `map_from_body` at all times.
  static Trajectory still(const Pose& map_from_body);

  /// @param poses  at least one; times finite and strictly rising
  /// @return kCorrupt naming the first pose (counted from 0) that breaks this
  static Result<Trajectory> make(std::vector<StampedPose> poses);

  /// map_from_body at a time; nullopt before the first pose and after the last.
  std::optional<Pose> at(double time_s) const;

  const std::vector<StampedPose>& poses() const { return poses_; }

 private:
  Trajectory(std::vector<StampedPose> poses, bool still) : poses_(std::move(poses)), still_(still) {}
  std::vector<StampedPose> poses_;
  bool still_;
};

}  // namespace pingvox
