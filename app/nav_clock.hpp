#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "json.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/nav/receiver_clock.hpp"
#include "pingvox/result.hpp"
#include "pingvox/slam/clock_offset.hpp"

namespace pingvox::app {

struct NavFiles;

/// One of the logs of navigation, and how its clock is joined to that of the first one.
struct NavLogClock {
  std::string name;
  double offset_s = 0.0;               ///< to add to its times to get those of the first one
  std::optional<double> deviation_s;   ///< standard deviation; nullopt: it was not estimated
  std::string from;                    ///< "both have dates"; empty of the first one
  std::vector<ClockSetting> settings;  ///< of the clock of who recorded it
};

/// What is added to the times of the navigation to get those of the sonar log, and how that is known.
struct NavOffset {
  double offset_s = 0.0;
  std::optional<double> deviation_s;  ///< standard deviation; nullopt: it was not estimated
  std::string from;                   ///< "--nav-offset", "both have dates"
  std::vector<NavLogClock> logs;      ///< of the navigation
};

/// The sonar log whose clock is wanted.
struct SonarLog {
  std::string name;  ///< "-" is standard input
  BeamTopic topic;   ///< of a bag
  Pose body_from_sonar = Pose::Identity();
};

/// kUnsupported when navigation cannot be joined to the log, which has no times.
/// @param name  of the log
Result<void> check_has_times(const BeamSource& source, const std::string& name);

/// The offset between the clocks of a sonar log and of navigation: what was `given`, else by their dates, else by the
/// turning of the sonar's picture. Times without dates that overlap are taken as those of one clock, unless the
/// navigation counts from the start of its device.
/// @return kUnsupported saying why when it cannot be told
Result<NavOffset> nav_offset(const std::optional<double>& given, const NavFiles& nav, const SonarLog& sonar,
                             Damage damage);

/// "+12.345 s (sd 0.021 s), by ...; -0.1 +- 0.3 s from how the sonar's picture turns"
std::string text_of(const NavOffset& offset, const std::optional<ClockOffset>& check);
/// What to do where the check is apart. @param option  the option that may be wrong
std::string wrong_clock_text(const ClockOffset& check, std::string_view option);
/// {"offset_s": ..., "sd_s": ..., "changes": ..., "several": ...}
JsonObject json_of(const ClockOffset& check);
/// {"offset_s": ..., "sd_s": ..., "from": ...}
JsonObject json_of(const NavOffset& offset);
/// The logs of the navigation among each other: lines of a report, none for a single log whose clock was not set.
std::string nav_logs_text(const NavOffset& offset);
/// {"name": ..., "offset_s": ..., "sd_s": ..., "from": ..., "clock_set": ...} for each
std::vector<JsonObject> nav_logs_json(const NavOffset& offset);
/// "by +1684351379.000 s at 1684351494.000 s, 2023-05-17 19:24:54"
std::string text_of(const ClockSetting& setting);
/// [{"at_s": ..., "by_s": ...}], by_s is null where it is not known
std::vector<JsonObject> json_of(std::span<const ClockSetting> settings);

}  // namespace pingvox::app
