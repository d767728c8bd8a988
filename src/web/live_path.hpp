#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"

namespace pingvox::web {

/// The path of a vehicle as it grows; a long one is thinned.
class LivePath {
 public:
  static constexpr std::size_t kMaxPoses = 20'000;

  const std::vector<StampedPose>& poses() const { return poses_; }
  /// Changes when poses that were there before have changed.
  std::uint32_t version() const { return version_; }

  /// Adds a pose if it is later than the last one.
  void add(const StampedPose& pose) {
    if (!poses_.empty() && pose.time_s <= poses_.back().time_s) return;
    poses_.push_back(pose);
    if (poses_.size() > kMaxPoses) replace(thinned(std::move(poses_)));
  }
  void replace(std::vector<StampedPose> poses) {
    poses_ = thinned(std::move(poses));
    ++version_;
  }

  /// Every second, fourth ... pose, to leave room for more.
  static std::vector<StampedPose> thinned(std::vector<StampedPose> poses) {
    while (poses.size() > kMaxPoses / 2) {
      for (std::size_t i = 0; 2 * i < poses.size(); ++i) poses[i] = poses[2 * i];
      poses.resize((poses.size() + 1) / 2);
    }
    return poses;
  }

 private:
  std::vector<StampedPose> poses_;
  std::uint32_t version_ = 1;
};

}  // namespace pingvox::web
