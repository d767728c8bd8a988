#include "nav_clock.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "console.hpp"
#include "map_report.hpp"
#include "nav_report.hpp"
#include "open_log.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/clock.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox::app {
namespace {

Result<Log> open(const SonarLog& sonar, Damage damage) {
  return ByteStream::open(sonar.name).and_then([&](ByteStream stream) {
    return open_log(std::move(stream), damage, std::nullopt, sonar.topic);
  });
}

/// From the first to the last of times in order; of those with dates, where a clock was set on the way.
template <class Stamped>
TimeSpan span_of(const std::vector<Stamped>& stamped) {
  const double last_s = stamped.back().time_s;
  const auto is_before = [](const Stamped& one) { return one.time_s < kFirstDate_s; };
  const auto first = last_s < kFirstDate_s ? stamped.begin() : std::ranges::find_if_not(stamped, is_before);
  return {first->time_s, last_s};
}

/// When there may be poses; sources that make none may be on another clock. nullopt: that is never.
std::optional<TimeSpan> span_of(const NavLog& nav) {
  if (const Result<NavTrajectory> path = nav_trajectory(nav, 0.0)) return span_of(path->trajectory.poses());
  // Dead reckoning, or turns alone.
  const NavSource* const attitude = nav.best(NavQuantity::kAttitude);
  const NavSource* const turns = attitude != nullptr ? attitude : nav.best(NavQuantity::kHeading);
  if (turns == nullptr) return std::nullopt;
  return span_of(turns->samples);
}

bool overlap(const TimeSpan& a, const TimeSpan& b) {
  return a.from_s <= b.to_s && b.from_s <= a.to_s;
}

/// Times and turns of the sonar log, from one pass over it.
struct SonarTimes {
  TimeSpan span;
  BeamClock clock = BeamClock::kOwn;
  std::vector<YawChange> changes;
};

enum class Want { kSpan, kTurns };

/// Of scans, whose turning is not looked at; nullopt: they have no times.
Result<std::optional<SonarTimes>> times_of(ScanSource& scans, const std::optional<TimeSpan>& enough) {
  std::optional<SonarTimes> times;
  for (;;) {
    const Result<std::optional<PointScan>> scan = scans.next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan || !(*scan)->time_s) return times;
    const double time_s = *(*scan)->time_s;
    if (!times) times = SonarTimes{{time_s, time_s}, BeamClock::kOwn, {}};
    times->span = {std::min(times->span.from_s, time_s), std::max(times->span.to_s, time_s)};
    if (enough && overlap(times->span, *enough)) return times;
  }
}

/// nullopt: it has no beams.
/// @param enough  the rest need not be read once the log overlaps it
Result<std::optional<SonarTimes>> times_of(const SonarLog& sonar, Damage damage, Want want,
                                           const std::optional<TimeSpan>& enough = std::nullopt) {
  auto log = open(sonar, damage);
  if (!log) return tl::unexpected(log.error());
  if (auto* scans = std::get_if<std::unique_ptr<ScanSource>>(&*log)) return times_of(**scans, enough);
  auto* source = std::get_if<std::unique_ptr<BeamSource>>(&*log);
  if (const auto has = check_has_times(**source, sonar.name); !has) return tl::unexpected(has.error());
  std::optional<SonarTimes> times;
  PictureTurns turns(sonar.body_from_sonar);
  for (;;) {
    Result<std::optional<Beam>> beam = (*source)->next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    const double time_s = (*beam)->time_s;
    if (!times) times = SonarTimes{{time_s, time_s}, (*source)->clock(), {}};
    times->span = {std::min(times->span.from_s, time_s), std::max(times->span.to_s, time_s)};
    if (enough && overlap(times->span, *enough)) break;
    if (want == Want::kTurns) turns.add(*std::move(*beam));
  }
  if (times) times->changes = turns.finish();
  return times;
}

/// Zero of the log's clock by the date in its name, which is that of its start: seconds since 1970 if it were UTC.
std::optional<double> zero_in_name(const std::string& name, BeamClock clock) {
  constexpr double kDay_s = 86'400.0;
  const std::optional<double> start_s = date_in_name(name);
  return start_s && clock == BeamClock::kTimeOfDay ? std::floor(*start_s / kDay_s) * kDay_s : start_s;
}

/// "2023-05-17 10:12:03", of a clock without dates "12.500 s".
std::string time_text(double time_s) {
  const std::string date = date_text(time_s);
  return date.empty() ? fmt::format("{:.3f} s", time_s) : date;
}

std::string span_text(const TimeSpan& span) {
  return fmt::format("{} to {}", time_text(span.from_s), time_text(span.to_s));
}

/// Of two that do not overlap: "--nav ends 2023-05-17 10:12:03, the log begins 2023-05-17 14:00:12"
std::string apart_text(const TimeSpan& log, const TimeSpan& nav) {
  if (nav.to_s < log.from_s) {
    return fmt::format("--nav ends {}, the log begins {}", time_text(nav.to_s), time_text(log.from_s));
  }
  return fmt::format("the log ends {}, --nav begins {}", time_text(log.to_s), time_text(nav.from_s));
}

std::string zone_text(double zone_s) {
  const auto minutes = static_cast<int>(zone_s / 60.0);
  return fmt::format("UTC{}{}:{:02}", minutes < 0 ? '-' : '+', std::abs(minutes) / 60, std::abs(minutes) % 60);
}

/// ": in UTC-7:00 --nav-offset -25200.000, in UTC-8:00 --nav-offset -28800.000", for each zone that may be meant
std::string zones_text(const std::vector<TimeZone>& zones, double zero_s) {
  constexpr std::size_t kMost = 4;
  std::string text;
  for (const TimeZone& zone : std::span(zones).first(std::min(zones.size(), kMost))) {
    text += fmt::format("{} in {} --nav-offset {:.3f}", text.empty() ? ":" : ",", zone_text(zone.local_from_utc_s),
                        zone.local_from_utc_s - zero_s);
  }
  return zones.size() > kMost ? text + ", or others" : text;
}

/// @param unknown  why the times do not tell it, for the error
Result<NavOffset> by_picture(const NavLog& nav, const SonarLog& sonar, Damage damage, const std::string& unknown) {
  const auto times = times_of(sonar, damage, Want::kTurns);
  if (!times) return tl::unexpected(times.error());
  const Result<ClockOffset> found = clock_offset(*times ? (*times)->changes : std::vector<YawChange>(), nav);
  if (!found) {
    return fail(
        Error::Code::kUnsupported,
        fmt::format("{}: {} and cannot be found: {}: give --nav-offset, the seconds to add to the times of --nav (0: "
                    "one clock)",
                    sonar.name, unknown, found.error().message));
  }
  return NavOffset{found->offset_s,
                   found->deviation_s,
                   fmt::format("the turning of the sonar's picture, {} parts of sweeps", found->changes),
                   {}};
}

/// By the dates of the navigation; the error is why they do not tell it.
tl::expected<NavOffset, std::string> by_dates(const TimeSpan& nav, const SonarLog& sonar, const SonarTimes& times) {
  const TimeSpan& span = times.span;
  if (overlap(span, nav)) {
    return NavOffset{0.0, std::nullopt, nav.to_s >= kFirstDate_s ? "both have dates" : "taken as one clock", {}};
  }
  const bool has_dates = span.from_s >= kFirstDate_s;
  const std::optional<double> zero_s = has_dates ? 0.0 : zero_in_name(sonar.name, times.clock);
  const std::string not_set = nav.to_s < kFirstDate_s ? "; --nav is of a clock that was not set" : "";
  constexpr const char* kUnknown = "the offset between its clock and that of --nav is not known";
  if (!zero_s) return tl::unexpected(fmt::format("{} ({}{})", kUnknown, apart_text(span, nav), not_set));
  // Programs without a time zone write local time.
  const TimeSpan local = {*zero_s + span.from_s, *zero_s + span.to_s};
  if (const auto zone_s = local_from_utc_s(local, nav)) {
    const char* const from =
        has_dates ? "both have dates, the sonar log's in " : "the date in the name of the sonar log, in ";
    return NavOffset{*zone_s - *zero_s, std::nullopt, from + zone_text(*zone_s), {}};
  }
  const std::vector<TimeZone> zones = time_zones(local, nav);
  if (!zones.empty()) {
    return tl::unexpected(fmt::format("{} ({} {}, --nav is of {}{})", kUnknown,
                                      has_dates ? "it is of" : "its name says", span_text(local), span_text(nav),
                                      zones_text(zones, *zero_s)));
  }
  return tl::unexpected(
      fmt::format("does not overlap --nav in time, whatever the time zone ({}{}{}), so that the offset "
                  "between their clocks is not known",
                  has_dates ? "" : "by the date in its name ", apart_text(local, nav), not_set));
}

Result<NavOffset> estimated_offset(const NavLog& nav, const SonarLog& sonar, Damage damage) {
  NavOffset one_clock{0.0, std::nullopt, "taken as one clock", {}};
  const std::optional<TimeSpan> nav_span = span_of(nav);
  if (sonar.name == "-" || !nav_span) return one_clock;  // a pipe is read once
  const Result<std::optional<SonarTimes>> times = times_of(sonar, damage, Want::kSpan, nav_span);
  if (!times || !*times) return one_clock;  // mapping the log reports the error
  const TimeSpan& span = (*times)->span;
  if (nav.clock() == NavClock::kUnix) {
    auto found = by_dates(*nav_span, sonar, **times);
    if (found) return *std::move(found);
    return by_picture(nav, sonar, damage, found.error());
  }
  if (nav.clock() == NavClock::kBoot) {
    return by_picture(nav, sonar, damage,
                      "the offset between its clock and that of --nav, which counts from the start of a device, is not "
                      "known");
  }
  if (overlap(span, *nav_span)) return one_clock;
  return by_picture(nav, sonar, damage,
                    fmt::format("does not overlap --nav in time ({}), so that the offset between their clocks is not "
                                "known",
                                apart_text(span, *nav_span)));
}

}  // namespace

Result<void> check_has_times(const BeamSource& source, const std::string& name) {
  if (source.clock() != BeamClock::kNone) return {};
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: --nav: the log has no times, so that navigation cannot be joined to it", name));
}

Result<NavOffset> nav_offset(const std::optional<double>& given, const NavFiles& nav, const SonarLog& sonar,
                             Damage damage) {
  Result<NavOffset> offset =
      given ? NavOffset{*given, std::nullopt, "--nav-offset", {}} : estimated_offset(nav.log, sonar, damage);
  if (offset) offset->logs = nav.clocks;
  return offset;
}

std::string text_of(const NavOffset& offset, const std::optional<ClockOffset>& check) {
  const std::string deviation = offset.deviation_s ? fmt::format(" (sd {:.3f} s)", *offset.deviation_s) : "";
  std::string checked = "not checked by the sonar";
  if (check) {
    checked =
        fmt::format("{:+.1f} +- {:.1f} s{} from how the sonar's picture turns", check->offset_s, check->deviation_s,
                    check->from_s              ? fmt::format(" since {:.1f} s", *check->from_s)
                    : check->is_one_of_several ? ", or another,"
                                               : "");
  }
  return fmt::format("{:+.3f} s{}: {}; {}", offset.offset_s, deviation, offset.from, checked);
}

std::string wrong_clock_text(const ClockOffset& check, std::string_view option) {
  if (check.from_s) {
    return fmt::format(
        "by the turning of the sonar's picture the clock of the {} jumped ahead by {:.1f} +- {:.1f} s, "
        "at {:.1f} s: what comes later is at wrong places",
        check.offset_s < 0.0 ? "poses" : "log", std::abs(check.offset_s), check.deviation_s, *check.from_s);
  }
  return fmt::format(
      "by the turning of the sonar's picture {:+.1f} +- {:.1f} s{} should be added to the times of the "
      "poses: is {} right?",
      check.offset_s, check.deviation_s, check.is_one_of_several ? ", or another number," : "", option);
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
  return json.add("from", offset.from);
}

std::string nav_logs_text(const NavOffset& offset) {
  std::string text;
  for (std::size_t i = 0; i < offset.logs.size(); ++i) {
    const NavLogClock& log = offset.logs[i];
    const std::string name = on_one_line(log.name);
    if (i > 0) {
      const std::string deviation = log.deviation_s ? fmt::format(" (sd {:.3f} s)", *log.deviation_s) : "";
      text += report_line("nav log", fmt::format("{}: {:+.3f} s{} to the clock of {}: {}", name, log.offset_s,
                                                 deviation, on_one_line(offset.logs.front().name), log.from));
    }
    for (const ClockSetting& setting : log.settings) {
      text += report_line("clock set", fmt::format("{}: that of the recorder, {}", name, text_of(setting)));
    }
  }
  return text;
}

std::vector<JsonObject> nav_logs_json(const NavOffset& offset) {
  std::vector<JsonObject> logs;
  for (const NavLogClock& log : offset.logs) {
    JsonObject& json = logs.emplace_back();
    json.add("name", log.name).add("offset_s", log.offset_s);
    log.deviation_s ? json.add("sd_s", *log.deviation_s) : json.add_null("sd_s");
    json.add("from", log.from).add("clock_set", json_of(log.settings));
  }
  return logs;
}

std::string text_of(const ClockSetting& setting) {
  const std::string date = date_text(setting.at_s);
  const std::string at = fmt::format("at {:.3f} s{}", setting.at_s, date.empty() ? "" : ", " + date);
  if (!setting.by_s) return at + ", by how much is not known: times before and after it do not agree";
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
