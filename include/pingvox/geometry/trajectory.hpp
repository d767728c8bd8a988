#pragma once

#include <cstddef>
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
  /// @param time_s  of its only pose
  static Trajectory still(const Pose& map_from_body, double time_s = 0.0);

  /// @param poses  at least one; times finite and strictly rising
  /// @param longest_step_s  poses farther apart in time have a gap between them
  /// @param cuts  indices of poses, rising and within 1..poses-1: between each of them and the one before it there is
  ///              a gap, too
  /// @return kCorrupt naming the first pose (counted from 0) that breaks this, or a wrong cut
  static Result<Trajectory> make(std::vector<StampedPose> poses,
                                 double longest_step_s = std::numeric_limits<double>::infinity(),
                                 std::vector<std::size_t> cuts = {});

  /// map_from_body at a time; nullopt before the first pose, after the last, and within a gap.
  std::optional<Pose> at(double time_s) const;

  const std::vector<StampedPose>& poses() const { return poses_; }
  double longest_step_s() const { return longest_step_s_; }
  const std::vector<std::size_t>& cuts() const { return cuts_; }
  std::size_t gaps() const;

 private:
  Trajectory(std::vector<StampedPose> poses, double longest_step_s, std::vector<std::size_t> cuts, bool still)
      : poses_(std::move(poses)), longest_step_s_(longest_step_s), cuts_(std::move(cuts)), still_(still) {}
  bool is_gap(std::size_t after) const;

  std::vector<StampedPose> poses_;
  double longest_step_s_;
  std::vector<std::size_t> cuts_;
  bool still_;
};

}  // namespace pingvox
