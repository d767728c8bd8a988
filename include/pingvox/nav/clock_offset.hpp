#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "pingvox/geometry/trajectory.hpp"
#include "pingvox/nav/device_clock.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/time_span.hpp"
#include "pingvox/result.hpp"

/// The offset between the clocks of two recordings of one vehicle, from its rotation.
namespace pingvox {

/// How much a yaw changed between two times of a clock [rad].
struct YawChange {
  double from_s = 0.0, to_s = 0.0;
  double by_rad = 0.0;
  double spread_s = 0.0;  ///< duration of what it was measured from; the times are its middle
};

/// How the vehicle turned, by its heading or attitude with most samples: a change for each second.
/// @return kCorrupt when the clock of a heading was set back
Result<std::vector<YawChange>> yaw_changes(const NavLog& log);

struct ClockOffset {
  double offset_s = 0.0;     ///< to add to the times of the navigation
  double deviation_s = 0.0;  ///< standard deviation
  std::size_t changes = 0;   ///< of yaw that were compared

  /// Ambiguous by some seconds: the vehicle turns alike in each round.
  bool is_one_of_several = false;
  /// Since when: one of the clocks jumped ahead then, and was right before. nullopt: all the time.
  std::optional<double> from_s = std::nullopt;

  /// Whether clocks that should agree do not: by more than five standard deviations and half a second.
  bool is_apart() const;
};

/// The offset with which the heading (or attitude) with most samples explains changes of yaw best, whatever the overlap
/// of the two recordings.
/// @return kUnsupported, with the reason, when it cannot be determined: no heading, too few changes, a vehicle that
/// turns
///         too little or evenly, or another offset that is nearly as good; kCorrupt when the clock of a heading was set
///         back
Result<ClockOffset> clock_offset(const std::vector<YawChange>& changes, const NavLog& log);

/// How the clocks of two navigation logs of one vehicle are offset.
struct NavClockOffset {
  enum class By {
    kDevice,  ///< both have times of one device's clock, and the vehicle turns alike by them
    kTurns,   ///< the heading in both
  };
  double offset_s = 0.0;     ///< to add to the times of the log that counts from a start
  double deviation_s = 0.0;  ///< standard deviation
  By by = By::kTurns;
};

/// The offset of a log that counts from the start of a device to one with other times.
/// @param runs  of devices, in the log `dated`
/// @return as clock_offset
Result<NavClockOffset> nav_clock_offset(const NavLog& dated, std::span<const DeviceRun> runs, const NavLog& from_start);

/// The error of the times of poses that should be on the clock of the changes: what is to be added to them.
/// As clock_offset, but of offsets up to ten minutes. Where a vehicle goes round and turns alike each time, the
/// smallest one that explains them, up to 40 s. One since a time (ClockOffset::from_s), where either clock paused and
/// the picture turned on as if it had jumped. nullopt: not observable.
/// @param pauses  of the changes, see PictureTurns
std::optional<ClockOffset> clock_error(const std::vector<YawChange>& changes, const std::vector<TimeSpan>& pauses,
                                       const Trajectory& trajectory);

}  // namespace pingvox
