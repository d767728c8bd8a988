#include "nav_clock.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "open_log.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/clock.hpp"
#include "pingvox/nav/nav_trajectory.hpp"

namespace pingvox::app {
namespace {

/// Times since the start of a device or of a log stay below it; 2001 since 1970.
constexpr double kFirstDate_s = 1e9;

Result<Log> open(const SonarLog& sonar, Damage damage) {
  return ByteStream::open(sonar.name).and_then([&](ByteStream stream) {
    return open_log(std::move(stream), damage, std::nullopt, sonar.topic);
  });
}

/// When there may be poses; sources that make none may be on another clock. nullopt: that is never.
std::optional<TimeSpan> span_of(const NavLog& nav) {
  if (const Result<NavTrajectory> path = nav_trajectory(nav, 0.0)) {
    const std::vector<StampedPose>& poses = path->trajectory.poses();
    return TimeSpan{poses.front().time_s, poses.back().time_s};
  }
  // Dead reckoning, or turns alone.
  const NavSource* const attitude = nav.best(NavQuantity::kAttitude);
  const NavSource* const turns = attitude != nullptr ? attitude : nav.best(NavQuantity::kHeading);
  if (turns == nullptr) return std::nullopt;
  return TimeSpan{turns->samples.front().time_s, turns->samples.back().time_s};
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

/// "2026-11-25", of seconds since 1970
std::string day_text(double time_s) {
  constexpr double kLast_s = 253'402'300'799.0;  // of the year 9999
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(static_cast<std::time_t>(std::clamp(time_s, 0.0, kLast_s))));
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

/// @param dates  what is known of the dates, for the error
Result<NavOffset> by_picture(const NavLog& nav, const SonarLog& sonar, Damage damage, const std::string& dates) {
  const auto times = times_of(sonar, damage, Want::kTurns);
  if (!times) return tl::unexpected(times.error());
  const Result<ClockOffset> found = clock_offset(*times ? (*times)->changes : std::vector<YawChange>(), nav);
  if (!found) {
    return fail(
        Error::Code::kUnsupported,
        fmt::format("{}: the offset between its clock and that of --nav is not known{} and cannot be found: {}: "
                    "give --nav-offset, the seconds to add to the times of --nav (0: one clock)",
                    sonar.name, dates, found.error().message));
  }
  return NavOffset{found->offset_s, found->deviation_s,
                   fmt::format("the turning of the sonar's picture, {} parts of sweeps", found->changes)};
}

}  // namespace

Result<void> check_has_times(const BeamSource& source, const std::string& name) {
  if (source.clock() != BeamClock::kNone) return {};
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: --nav: the log has no times, so that navigation cannot be joined to it", name));
}

Result<NavOffset> nav_offset(const std::optional<double>& given, const NavLog& nav, const SonarLog& sonar,
                             Damage damage) {
  if (given) return NavOffset{*given, std::nullopt, "--nav-offset"};
  NavOffset one_clock{0.0, std::nullopt, "taken as one clock"};
  const std::optional<TimeSpan> nav_span = span_of(nav);
  if (sonar.name == "-" || !nav_span) return one_clock;  // a pipe is read once
  const Result<std::optional<SonarTimes>> times = times_of(sonar, damage, Want::kSpan, nav_span);
  if (!times || !*times) return one_clock;  // mapping the log reports the error
  const TimeSpan& span = (*times)->span;

  const bool nav_has_dates = nav.clock() == NavClock::kUnix;
  if (nav_has_dates && overlap(span, *nav_span)) return NavOffset{0.0, std::nullopt, "both have dates"};
  std::string dates;
  if (nav_has_dates) {
    const bool has_dates = span.from_s >= kFirstDate_s;
    const std::optional<double> zero_s = has_dates ? 0.0 : zero_in_name(sonar.name, (*times)->clock);
    if (zero_s) {
      // Programs without a time zone write local time.
      const TimeSpan local = {*zero_s + span.from_s, *zero_s + span.to_s};
      if (const auto zone_s = local_from_utc_s(local, *nav_span)) {
        const char* const from =
            has_dates ? "both have dates, the sonar log's in " : "the date in the name of the sonar log, in ";
        return NavOffset{*zone_s - *zero_s, std::nullopt, from + zone_text(*zone_s)};
      }
      dates =
          fmt::format(" ({} {}, --nav is of {}{})", has_dates ? "it is of" : "its name says", day_text(local.from_s),
                      day_text(nav_span->from_s), zones_text(time_zones(local, *nav_span), *zero_s));
    }
  }
  if (nav.clock() == NavClock::kUnknown && overlap(span, *nav_span)) return one_clock;
  return by_picture(nav, sonar, damage, dates);
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

}  // namespace pingvox::app
