#include "nav_clock.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstddef>

#include "console.hpp"
#include "map_report.hpp"

namespace pingvox::app {

std::string from_text(const NavOffset& offset) {
  using By = NavOffset::By;
  switch (offset.by) {
    case By::kGiven:
      return "--nav-offset";
    case By::kDates:
      return "both have dates";
    case By::kLocalDates:
      return "both have dates, the sonar log's in " + zone_text(offset.local_from_utc_s);
    case By::kDateInName:
      return "the date in the name of the sonar log, in " + zone_text(offset.local_from_utc_s);
    case By::kPicture:
      return fmt::format("the rotation of the sonar image, {} parts of sweeps", offset.picture_turns);
    case By::kOneClock:
      break;
  }
  return "assumed to be one clock";
}

std::string from_text(NavLogClock::By by) {
  using By = NavLogClock::By;
  switch (by) {
    case By::kFirst:
      return "";
    case By::kDevice:
      return "the clock of the autopilot";
    case By::kTurns:
      return "how the vehicle turns";
    case By::kDates:
      return "both have dates";
    case By::kSameStart:
      return "both count from the start of the device";
    case By::kOneClock:
      break;
  }
  return "assumed to be one clock";
}

std::string text_of(const NavOffset& offset, const std::optional<ClockOffset>& check) {
  const std::string deviation = offset.deviation_s ? fmt::format(" (sd {:.3f} s)", *offset.deviation_s) : "";
  std::string checked = "not checked by the sonar";
  if (check) {
    checked =
        fmt::format("{:+.1f} +- {:.1f} s{} from the rotation of the sonar image", check->offset_s, check->deviation_s,
                    check->from_s              ? fmt::format(" since {:.1f} s", *check->from_s)
                    : check->is_one_of_several ? ", or another,"
                                               : "");
  }
  return fmt::format("{:+.3f} s{}: {}; {}", offset.offset_s, deviation, from_text(offset), checked);
}

std::string wrong_clock_text(const ClockOffset& check, std::string_view advice) {
  if (check.from_s) {
    return fmt::format(
        "by the rotation of the sonar image the clock of the {} jumped ahead by {:.1f} +- {:.1f} s, "
        "at {:.1f} s: later data is misplaced",
        check.offset_s < 0.0 ? "poses" : "log", std::abs(check.offset_s), check.deviation_s, *check.from_s);
  }
  return fmt::format(
      "by the rotation of the sonar image {:+.1f} +- {:.1f} s{} should be added to the times of the poses: {}",
      check.offset_s, check.deviation_s, check.is_one_of_several ? ", or another number," : "", advice);
}

std::string nav_offset_advice(const NavOffset& offset, const ClockOffset& check) {
  return fmt::format("try --nav-offset {:.3f}", offset.offset_s + check.offset_s);
}

JsonObject json_of(const ClockOffset& check) {
  JsonObject json;
  json.add("offset_s", check.offset_s)
      .add("sd_s", check.deviation_s)
      .add("changes", check.changes)
      .add_truth("several", check.is_one_of_several);
  return check.from_s ? json.add("from_s", *check.from_s) : json.add_null("from_s");
}

JsonObject json_of(const NavOffset& offset) {
  JsonObject json;
  json.add("offset_s", offset.offset_s);
  offset.deviation_s ? json.add("sd_s", *offset.deviation_s) : json.add_null("sd_s");
  return json.add("from", from_text(offset));
}

std::string nav_logs_text(std::span<const NavLogClock> logs) {
  std::string text;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const NavLogClock& log = logs[i];
    const std::string name = on_one_line(log.name);
    if (i > 0) {
      const std::string deviation = log.deviation_s ? fmt::format(" (sd {:.3f} s)", *log.deviation_s) : "";
      text += report_line("nav log", fmt::format("{}: {:+.3f} s{} to the clock of {}: {}", name, log.offset_s,
                                                 deviation, on_one_line(logs.front().name), from_text(log.by)));
    }
    for (const ClockSetting& setting : log.settings) {
      text += report_line("clock set", fmt::format("{}: that of the recorder, {}", name, text_of(setting)));
    }
  }
  return text;
}

std::vector<JsonObject> nav_logs_json(std::span<const NavLogClock> logs) {
  std::vector<JsonObject> list;
  for (const NavLogClock& log : logs) {
    JsonObject& json = list.emplace_back();
    json.add("name", log.name).add("offset_s", log.offset_s);
    log.deviation_s ? json.add("sd_s", *log.deviation_s) : json.add_null("sd_s");
    json.add("from", from_text(log.by)).add("clock_set", json_of(log.settings));
  }
  return list;
}

std::string text_of(const ClockSetting& setting) {
  const std::string date = date_text(setting.at_s);
  const std::string at = fmt::format("at {:.3f} s{}", setting.at_s, date.empty() ? "" : ", " + date);
  if (!setting.by_s) return at + ", by an unknown amount: times before and after it do not agree";
  return fmt::format("by {:+.3f} s {}: all times are on one clock, by those of the device", *setting.by_s, at);
}

std::vector<JsonObject> json_of(std::span<const ClockSetting> settings) {
  std::vector<JsonObject> list;
  for (const ClockSetting& setting : settings) {
    JsonObject& json = list.emplace_back();
    json.add("at_s", setting.at_s);
    setting.by_s ? json.add("by_s", *setting.by_s) : json.add_null("by_s");
  }
  return list;
}

}  // namespace pingvox::app
