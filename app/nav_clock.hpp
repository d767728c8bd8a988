#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/internal/json.hpp"
#include "pingvox/nav/clock_offset.hpp"
#include "pingvox/nav/receiver_clock.hpp"
#include "pingvox/recording/nav_offset.hpp"
#include "pingvox/recording/navigation.hpp"

namespace pingvox::app {

/// How it is known: "both have dates".
std::string from_text(const NavOffset& offset);
std::string from_text(NavLogClock::By by);

/// "+12.345 s (sd 0.021 s), by ...; -0.1 +- 0.3 s from the rotation of the sonar image"
std::string text_of(const NavOffset& offset, const std::optional<ClockOffset>& check);
/// What is wrong where the check is apart, and what to do.
std::string wrong_clock_text(const ClockOffset& check, std::string_view advice);
/// "try --nav-offset -3.250"
std::string nav_offset_advice(const NavOffset& offset, const ClockOffset& check);
/// {"offset_s": ..., "sd_s": ..., "changes": ..., "several": ...}
JsonObject json_of(const ClockOffset& check);
/// {"offset_s": ..., "sd_s": ..., "from": ...}
JsonObject json_of(const NavOffset& offset);
/// The logs of the navigation among each other: lines of a report, none for a single log whose clock was not set.
std::string nav_logs_text(std::span<const NavLogClock> logs);
/// {"name": ..., "offset_s": ..., "sd_s": ..., "from": ..., "clock_set": ...} for each
std::vector<JsonObject> nav_logs_json(std::span<const NavLogClock> logs);
/// "by +1684351379.000 s at 1684351494.000 s, 2023-05-17 19:24:54"
std::string text_of(const ClockSetting& setting);
/// [{"at_s": ..., "by_s": ...}], by_s is null where it is not known
std::vector<JsonObject> json_of(std::span<const ClockSetting> settings);

}  // namespace pingvox::app
