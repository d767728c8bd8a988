#pragma once

#include <optional>
#include <string_view>

namespace pingvox {

/// The date and time of day anywhere in the name of a log, as Ping Viewer writes it ("20240405-091648974.bin") and
/// others do ("dive1 2024-04-05 09-19-03.csv"), with no digits before or behind it: seconds since 1970 if it were UTC,
/// though programs write local time. nullopt: there is none, or two different ones.
std::optional<double> date_in_name(std::string_view path);

/// A stretch of time.
struct TimeSpan {
  double from_s = 0.0, to_s = 0.0;
};

/// Offset of local time from UTC: the multiple of a quarter of an hour, from -12 to +14 hours, with which the two spans
/// overlap. nullopt: there is none, or several.
std::optional<double> local_from_utc_s(const TimeSpan& local, const TimeSpan& utc);

}  // namespace pingvox
