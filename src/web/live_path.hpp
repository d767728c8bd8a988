#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"

namespace pingvox::web {

/// Where a vehicle was, as it grows. Of a long path some poses are left out.
class LivePath {
 public:
  static constexpr std::size_t kMaxPoses = 20'000;

  const std::vector<StampedPose>& poses() const { return poses_; }
  /// Another one when poses have changed that were there before.
  std::uint32_t version() const { return version_; }

  /// Takes a pose, unless it is not later than the last one.
  void add(const StampedPose& pose) {
    if (!poses_.empty() && pose.time_s <= poses_.back().time_s) return;
    poses_.push_back(pose);
    if (poses_.size() > kMaxPoses) replace(thinned(std::move(poses_)));
  }
  void replace(std::vector<StampedPose> poses) {
    poses_ = thinned(std::move(poses));
    ++version_;
  }

  /// Each second, fourth ... pose, so that there is room for more.
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
