#pragma once

#include <optional>
#include <string>

#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/time_span.hpp"
#include "pingvox/recording/nav_offset.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// The times of a sonar log, from its first to its last beam.
struct LogSpan {
  TimeSpan span;
  BeamClock clock = BeamClock::kOwn;
};

/// Reads a log to its end. nullopt: it has no beams, or scans without times.
/// @return kUnsupported when beams have no times; errors of reading
Result<std::optional<LogSpan>> log_span(const SonarLog& sonar);

/// When there may be poses; other sources may be on another clock. nullopt: never.
std::optional<TimeSpan> nav_span(const NavLog& nav);

/// Zero of the log's clock by the date in its name, which is that of its start: seconds since 1970 if it were UTC.
std::optional<double> zero_in_name(const std::string& name, BeamClock clock);

/// "2023-05-17 10:12:03", of a clock without dates "12.500 s".
std::string time_text(double time_s);

/// Of two that do not overlap: "the navigation ends 2023-05-17 10:12:03, the log begins 2023-05-17 14:00:12"
std::string apart_text(const TimeSpan& log, const TimeSpan& nav);

}  // namespace pingvox
