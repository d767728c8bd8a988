#pragma once

#include <optional>
#include <span>
#include <vector>

namespace pingvox {

/// When a message was received, and when it was made by the clock of its device [s].
struct DeviceTime {
  double received_s = 0.0, made_s = 0.0;
};

/// Whether the device restarted between two messages: it has not been up for longer than the time between them.
bool was_restarted(const DeviceTime& before, const DeviceTime& now);

/// Puts times of a device's own clock on the receiver's clock, as its messages arrive. Delays vary and only
/// add, so the smallest difference of the two clocks is the nearest; that of the last minute or two, for clocks drift.
/// A clock that goes back by more than a second, or jumps by more than a minute, was set, or its device restarted.
class DeviceClock {
 public:
  /// @return when the message was made, on the receiver's clock
  double add(const DeviceTime& time);

 private:
  std::optional<DeviceTime> last_;
  double minute_ = 0.0;                                ///< of the receiver's clock, counted from its 0
  double smallest_s_ = 0.0, smallest_before_s_ = 0.0;  ///< difference in this minute, and in the one before
};

/// The same of a whole recording, in which the minute after a message counts as well.
/// @param times  in the order of the recording
std::vector<double> device_times_s(std::span<const DeviceTime> times);

/// A device from one of its starts to the next, as far as its messages were received. Times are on the clock of the
/// receiver.
struct DeviceRun {
  double zero_s = 0.0;       ///< when its clock was 0
  double deviation_s = 0.0;  ///< standard deviation, of what the clocks drift and of the smallest delay
  double from_s = 0.0, to_s = 0.0;
};
/// @param times  in the order of the recording
std::vector<DeviceRun> device_runs(std::span<const DeviceTime> times);

}  // namespace pingvox
