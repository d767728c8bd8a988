#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/nav_device.hpp"
#include "live/recordings.hpp"
#include "nav/internal/live_poses.hpp"
#include "pingvox/live/live_options.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Pose of the vehicle by all navigation devices, on the clock of the beams.
class LiveNavigation {
 public:
  /// @param since_1970_s  the date of time 0
  /// @param node          for topics of ROS 2
  static Result<LiveNavigation> open(const std::vector<LiveNav>& from, Recordings& recordings, double since_1970_s,
                                     const std::optional<Ros2Node>& node);

  /// Ends the recordings, and begins others beside that of the sonar; none where that is not recorded.
  Result<void> record(Recordings& recordings);

  const std::vector<NavDevice>& devices() const { return devices_; }
  std::size_t messages() const;
  const LivePoses& poses() const { return poses_; }
  std::vector<LivePoses::NewFrame> take_new_frames() { return poses_.take_new_frames(); }

  /// Reads what has arrived at all devices. @return the first error, after which it may be called again
  Result<void> step(double now_s);
  /// Takes a sample of a source of a device, by its number.
  using Take = std::function<void(std::size_t device, const std::string& source, NavQuantity, const NavSample&)>;
  /// Reads what has arrived, for another one to tell the poses.
  Result<void> step(double now_s, const Take& take);

  /// Of the last step.
  double now_s() const { return now_s_; }
  /// Whether the pose of a beam may still become known.
  bool may_come(double beam_s) const;
  /// How old the latest pose is; infinity: none is known.
  double pose_age_s() const;

 private:
  explicit LiveNavigation(std::vector<NavDevice> devices) : devices_(std::move(devices)) {}

  std::vector<NavDevice> devices_;
  LivePoses poses_;
  double now_s_ = 0.0;
};

}  // namespace pingvox
