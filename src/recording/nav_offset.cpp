#include "pingvox/recording/nav_offset.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "io/internal/clock.hpp"
#include "pingvox/io/open_log.hpp"
#include "pingvox/nav/clock_offset.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "pingvox/nav/receiver_clock.hpp"
#include "recording/log_spans.hpp"
#include "slam/internal/picture_turns.hpp"

namespace pingvox {
namespace {

Result<Log> open(const SonarLog& sonar) {
  return sonar.file.open().and_then(
      [&](ByteStream stream) { return open_log(std::move(stream), sonar.damage, std::nullopt, sonar.topic); });
}

/// From the first to the last of times in order; of those with dates, where a clock was set on the way.
template <class Stamped>
TimeSpan span_of(const std::vector<Stamped>& stamped) {
  const double last_s = stamped.back().time_s;
  const auto is_before = [](const Stamped& one) { return one.time_s < kFirstDate_s; };
  const auto first = last_s < kFirstDate_s ? stamped.begin() : std::ranges::find_if_not(stamped, is_before);
  return {first->time_s, last_s};
}

bool overlaps(const TimeSpan& a, const TimeSpan& b) {
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
    if (enough && overlaps(times->span, *enough)) return times;
  }
}

/// nullopt: it has no beams.
/// @param enough  the rest need not be read once the log overlaps it
Result<std::optional<SonarTimes>> times_of(const SonarLog& sonar, Want want,
                                           const std::optional<TimeSpan>& enough = std::nullopt) {
  auto log = open(sonar);
  if (!log) return tl::unexpected(log.error());
  if (auto* scans = std::get_if<std::unique_ptr<ScanSource>>(&*log)) return times_of(**scans, enough);
  auto* source = std::get_if<std::unique_ptr<BeamSource>>(&*log);
  if (const auto has = check_has_times(**source, sonar.file.name()); !has) return tl::unexpected(has.error());
  std::optional<SonarTimes> times;
  PictureTurns turns(sonar.body_from_sonar);
  for (;;) {
    Result<std::optional<Beam>> beam = (*source)->next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    const double time_s = (*beam)->time_s;
    if (!times) times = SonarTimes{{time_s, time_s}, (*source)->clock(), {}};
    times->span = {std::min(times->span.from_s, time_s), std::max(times->span.to_s, time_s)};
    if (enough && overlaps(times->span, *enough)) break;
    if (want == Want::kTurns) turns.add(*std::move(*beam));
  }
  if (times) times->changes = turns.finish();
  return times;
}

std::string span_text(const TimeSpan& span) {
  return fmt::format("{} to {}", time_text(span.from_s), time_text(span.to_s));
}

/// ": in UTC-7:00 nav_offset_s -25200.000, in UTC-8:00 nav_offset_s -28800.000", for each zone that may be meant
std::string zones_text(const std::vector<TimeZone>& zones, double zero_s) {
  constexpr std::size_t kMaxZones = 4;
  std::string text;
  for (const TimeZone& zone : std::span(zones).first(std::min(zones.size(), kMaxZones))) {
    text += fmt::format("{} in {} nav_offset_s {:.3f}", text.empty() ? ":" : ",", zone_text(zone.local_from_utc_s),
                        zone.local_from_utc_s - zero_s);
  }
  return zones.size() > kMaxZones ? text + ", or others" : text;
}

/// @param nav_span  of its poses
/// @param unknown   why the times do not determine it, for the error
Result<NavOffset> by_picture(const NavLog& nav, const TimeSpan& nav_span, const SonarLog& sonar,
                             const std::string& unknown) {
  const auto times = times_of(sonar, Want::kTurns);
  if (!times) return tl::unexpected(times.error());
  const Result<ClockOffset> found = clock_offset(*times ? (*times)->changes : std::vector<YawChange>(), nav);
  if (!found) {
    return fail(
        Error::Code::kUnsupported,
        fmt::format(
            "{}: {} and cannot be found: {}: give nav_offset_s, the seconds to add to the times of the "
            "navigation (0: one clock{})",
            sonar.file.name(), unknown, found.error().message,
            *times ? fmt::format("; {:.3f} aligns their beginnings", (*times)->span.from_s - nav_span.from_s) : ""));
  }
  return NavOffset{.offset_s = found->offset_s,
                   .deviation_s = found->deviation_s,
                   .by = NavOffset::By::kPicture,
                   .picture_turns = found->changes};
}

/// By the dates of the navigation; the error is why they do not determine it.
tl::expected<NavOffset, std::string> by_dates(const TimeSpan& nav, const SonarLog& sonar, const SonarTimes& times) {
  const TimeSpan& span = times.span;
  if (overlaps(span, nav)) {
    return NavOffset{.by = nav.to_s >= kFirstDate_s ? NavOffset::By::kDates : NavOffset::By::kOneClock};
  }
  const bool has_dates = span.from_s >= kFirstDate_s;
  const std::optional<double> zero_s = has_dates ? 0.0 : zero_in_name(sonar.file.name(), times.clock);
  const std::string not_set = nav.to_s < kFirstDate_s ? "; the navigation is of a clock that was not set" : "";
  constexpr const char* kUnknown = "the offset between its clock and that of the navigation is not known";
  if (!zero_s) return tl::unexpected(fmt::format("{} ({}{})", kUnknown, apart_text(span, nav), not_set));
  // Programs without a time zone write local time.
  const TimeSpan local = {*zero_s + span.from_s, *zero_s + span.to_s};
  if (const auto zone_s = local_from_utc_s(local, nav)) {
    return NavOffset{.offset_s = *zone_s - *zero_s,
                     .by = has_dates ? NavOffset::By::kLocalDates : NavOffset::By::kDateInName,
                     .local_from_utc_s = *zone_s};
  }
  const std::vector<TimeZone> zones = time_zones(local, nav);
  if (!zones.empty()) {
    return tl::unexpected(fmt::format("{} ({} {}, the navigation is of {}{})", kUnknown,
                                      has_dates ? "it is of" : "its name says", span_text(local), span_text(nav),
                                      zones_text(zones, *zero_s)));
  }
  return tl::unexpected(
      fmt::format("does not overlap the navigation in time, whatever the time zone ({}{}{}), so that the "
                  "offset between their clocks is not known",
                  has_dates ? "" : "by the date in its name ", apart_text(local, nav), not_set));
}

}  // namespace

std::optional<TimeSpan> nav_span(const NavLog& nav) {
  if (const Result<NavTrajectory> path = nav_trajectory(nav, 0.0)) return span_of(path->trajectory.poses());
  // Dead reckoning, or turns alone.
  const NavSource* const attitude = nav.best(NavQuantity::kAttitude);
  const NavSource* const turns = attitude != nullptr ? attitude : nav.best(NavQuantity::kHeading);
  if (turns == nullptr) return std::nullopt;
  return span_of(turns->samples);
}

Result<std::optional<LogSpan>> log_span(const SonarLog& sonar) {
  return times_of(sonar, Want::kSpan).map([](const std::optional<SonarTimes>& times) {
    return times ? std::optional(LogSpan{times->span, times->clock}) : std::nullopt;
  });
}

std::optional<double> zero_in_name(const std::string& name, BeamClock clock) {
  constexpr double kDay_s = 86'400.0;
  const std::optional<double> start_s = date_in_name(name);
  return start_s && clock == BeamClock::kTimeOfDay ? std::floor(*start_s / kDay_s) * kDay_s : start_s;
}

std::string time_text(double time_s) {
  const std::string date = date_text(time_s);
  return date.empty() ? fmt::format("{:.3f} s", time_s) : date;
}

std::string apart_text(const TimeSpan& log, const TimeSpan& nav) {
  if (nav.to_s < log.from_s) {
    return fmt::format("the navigation ends {}, the log begins {}", time_text(nav.to_s), time_text(log.from_s));
  }
  return fmt::format("the log ends {}, the navigation begins {}", time_text(log.to_s), time_text(nav.from_s));
}

std::string zone_text(double local_from_utc_s) {
  const auto minutes = static_cast<int>(local_from_utc_s / 60.0);
  return fmt::format("UTC{}{}:{:02}", minutes < 0 ? '-' : '+', std::abs(minutes) / 60, std::abs(minutes) % 60);
}

Result<void> check_has_times(const BeamSource& source, const std::string& name) {
  if (source.clock() != BeamClock::kNone) return {};
  return fail(Error::Code::kUnsupported,
              fmt::format("{}: has no times, so that navigation cannot be joined to it", name));
}

Result<NavOffset> find_nav_offset(const NavLog& nav, const SonarLog& sonar) {
  constexpr NavOffset kOneClock{};
  const std::optional<TimeSpan> path_span = nav_span(nav);
  if (sonar.file.is_standard_input() || !path_span) return kOneClock;  // a pipe is read once
  const Result<std::optional<SonarTimes>> times = times_of(sonar, Want::kSpan, path_span);
  if (!times || !*times) return kOneClock;  // mapping the log reports the error
  const TimeSpan& span = (*times)->span;
  constexpr double kTooLate_s = 1e11;
  if (span.from_s >= kTooLate_s) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{}: its times begin at {:.6g} s, thousands of years after 1970: are they in ms, us or ns?",
                            sonar.file.name(), span.from_s));
  }
  if (nav.clock() == NavClock::kUnix) {
    auto found = by_dates(*path_span, sonar, **times);
    if (found) return *std::move(found);
    return by_picture(nav, *path_span, sonar, found.error());
  }
  if (nav.clock() == NavClock::kBoot) {
    return by_picture(nav, *path_span, sonar,
                      "the offset between its clock and that of the navigation, which counts from the start of a "
                      "device, is not known");
  }
  if (overlaps(span, *path_span)) return kOneClock;
  return by_picture(nav, *path_span, sonar,
                    fmt::format("does not overlap the navigation in time ({}), so that the offset between their "
                                "clocks is not known",
                                apart_text(span, *path_span)));
}

}  // namespace pingvox
