#pragma once

#include <limits>
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
  /// @param longest_step_s  poses farther apart in time have a gap between them
  /// @return kCorrupt naming the first pose (counted from 0) that breaks this
  static Result<Trajectory> make(std::vector<StampedPose> poses,
                                 double longest_step_s = std::numeric_limits<double>::infinity());

  /// map_from_body at a time; nullopt before the first pose, after the last, and within a gap.
  std::optional<Pose> at(double time_s) const;

  const std::vector<StampedPose>& poses() const { return poses_; }
  double longest_step_s() const { return longest_step_s_; }
  std::size_t gaps() const;

 private:
  Trajectory(std::vector<StampedPose> poses, double longest_step_s, bool still)
      : poses_(std::move(poses)), longest_step_s_(longest_step_s), still_(still) {}
  std::vector<StampedPose> poses_;
  double longest_step_s_;
  bool still_;
};

}  // namespace pingvox
