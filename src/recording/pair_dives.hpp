#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/time_span.hpp"
#include "pingvox/recording/campaign.hpp"

namespace pingvox {

/// The times of a sonar log, to pair it with navigation.
struct LogTimes {
  std::string path;
  TimeSpan span;
  /// Of the zero of its clock, perhaps in local time: seconds since 1970. nullopt: it has no dates.
  std::optional<double> zero_s = std::nullopt;
  bool are_dates_own = false;  ///< its times are dates; else its name has one
};

/// The times of a navigation log, to pair it with sonar logs.
struct NavTimes {
  std::string path;
  TimeSpan span;
  enum class Clock {
    kDates,
    kStart,    ///< the start of a device
    kUnknown,  ///< no dates
  };
  Clock clock = Clock::kUnknown;
  /// Its quantities, and when it has them.
  struct Source {
    std::string name;
    NavQuantity quantity = NavQuantity::kVelocity;
    TimeSpan span;
  };
  std::vector<Source> sources = {};
};

/// Navigation of one log, by its number; or why there is none.
struct NavOfLog {
  std::vector<std::size_t> navs;
  std::optional<double> offset_s = std::nullopt;  ///< as Dive::nav_offset_s
  std::string reason = {};
  std::vector<std::size_t> in_conflict = {};  ///< navigation of its time that cannot be used together
};

/// The navigation of each log, as plan_campaign says.
/// @param offset_s  added to the times of the navigation, if that was given
std::vector<NavOfLog> pair_by_time(std::span<const LogTimes> logs, std::span<const NavTimes> navs,
                                   const std::optional<double>& offset_s);

}  // namespace pingvox
