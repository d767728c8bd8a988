#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/clock_watch.hpp"
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

  /// Ends the recordings, and begins new ones beside that of the sonar; none where that is not recorded.
  Result<void> record(Recordings& recordings);

  const std::vector<NavDevice>& devices() const { return devices_; }
  std::size_t messages() const;
  const LivePoses& poses() const { return poses_; }
  std::vector<LivePoses::NewFrame> take_new_frames() { return poses_.take_new_frames(); }

  /// Reads what has arrived at all devices. @return the first error, after which it may be called again
  Result<void> step(double now_s);
  /// Takes a sample of a source of a device, by its number.
  using Take = std::function<void(std::size_t device, const std::string& source, NavQuantity, const NavSample&)>;
  /// Reads what has arrived, without poses.
  Result<void> step(double now_s, const Take& take);

  /// Of the last step.
  double now_s() const { return now_s_; }
  /// How long a beam waits for its pose after it arrived.
  static constexpr double kPatience_s = 1.0;
  /// Whether the pose of a beam may still become known.
  /// @param beam_s     by its stamp, which may be of another clock than `now_s`
  /// @param arrived_s  by the clock of `now_s`
  bool may_come(double beam_s, double arrived_s) const;
  /// Age of the latest pose; infinity: none is known.
  double pose_age_s() const;
  /// When the latest pose arrived, by the clock of `now_s`, whatever its stamp. nullopt: none has.
  const std::optional<double>& pose_came_s() const { return pose_came_s_; }

  /// Notes the arrival of a beam. @param lag_s  after its stamp
  void note_beam(double lag_s) { clocks_.add_beam(lag_s); }
  /// Restarts the comparison of the clocks.
  void restart_clocks() { clocks_.restart(now_s_); }
  /// The devices whose stamps were found to differ from those of the beams since the last call.
  std::vector<ClockWatch::Difference> take_clock_differences() { return clocks_.update(now_s_); }

 private:
  explicit LiveNavigation(std::vector<NavDevice> devices) : devices_(std::move(devices)), clocks_(devices_.size()) {}
  Result<void> read(double now_s, const Take& take);
  void note_sample(std::size_t device, const NavSample& sample);

  std::vector<NavDevice> devices_;
  LivePoses poses_;
  ClockWatch clocks_;
  double now_s_ = 0.0;
  std::optional<double> pose_came_s_;
};

}  // namespace pingvox
