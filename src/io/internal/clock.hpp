#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/nav/time_span.hpp"

namespace pingvox {

/// The date and time of day anywhere in the name of a log, as Ping Viewer writes it ("20240405-091648974.bin") and
/// others do ("dive1 2024-04-05 09-19-03.csv"), with no digits before or behind it: seconds since 1970 if it were UTC,
/// though programs write local time. nullopt: there is none, or two different ones.
std::optional<double> date_in_name(std::string_view path);

/// "2023-05-04 17:22:21" of seconds since 1970; "" of the times of clocks that do not count from there.
std::string date_text(double time_s);

/// An offset of local time from UTC that is in civil use.
struct TimeZone {
  double local_from_utc_s = 0.0;
  double share = 0.0;  ///< how much of the shorter of the two spans lies in the other with it: 0 to 1
};

/// The time zones with which a span in local time and one in UTC overlap, the one with the greatest share first.
std::vector<TimeZone> time_zones(const TimeSpan& local, const TimeSpan& utc);

/// The zone of `time_zones` with which nine tenths of the shorter span lie in the other one, if the next one has at
/// most four fifths of its share. nullopt: none can be told from the others.
std::optional<double> local_from_utc_s(const TimeSpan& local, const TimeSpan& utc);

}  // namespace pingvox
