#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace pingvox {

/// Dates before it [s since 1970] are those of a clock that was not set: computers without one start in 1970, 1980 or
/// 2000. It is 2001-09-09 UTC; times since the start of a device or of a log stay below it.
inline constexpr double kFirstDate_s = 1e9;

/// A message as it was recorded.
struct ReceivedMessage {
  double received_s = 0.0;       ///< by the recorder's clock
  std::optional<double> made_s;  ///< by the clock of one device, that of all messages that have it; nullopt: not known
};

/// Where the recorder's clock was set.
struct ClockSetting {
  double at_s = 0.0;           ///< the first time after it, on the clock of the log
  std::optional<double> by_s;  ///< ahead, or back if it is negative; nullopt: unknown
};

/// The times of a log on one clock, though that of the recorder was set meanwhile.
struct ReceiverTimes {
  std::vector<double> times_s;  ///< of each message
  std::vector<ClockSetting> settings;
};

/// Finds where the clock of a recorder was set: its times go back by more than a second, or run ahead of the device's
/// by more than two seconds and stay there, which no delay does. The amount follows from the device's clock; all times
/// are then on the clock of the last part with dates, or of the last part. Where it does not, as the device restarted
/// at that time, the times before and after it stay as they are.
/// @param messages  in the order of the recording
ReceiverTimes receiver_times(std::span<const ReceivedMessage> messages);

}  // namespace pingvox
