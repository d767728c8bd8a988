#include "io/internal/clock.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "io/bytes/date.hpp"

namespace pingvox {

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Cuts a number of that many digits off the start, with separators in front of it; false: there is none.
bool cut_digits(std::string_view& text, std::size_t count, std::string_view separators, std::string& to) {
  const std::size_t first = std::min(text.find_first_not_of(separators), text.size());
  const std::string_view number = text.substr(first, count);
  if (number.size() != count || !std::ranges::all_of(number, is_digit)) return false;
  to += number;
  text.remove_prefix(first + count);
  return true;
}

/// Cuts a date and a time of day off the start of `text`; nullopt: there is none, or digits follow.
std::optional<double> cut_date(std::string_view& text) {
  constexpr std::string_view kBetween = "-_ ", kBeforeTime = "-_ T";
  constexpr double kFirst_s = 0.0, kLast_s = 4'102'444'800.0;  // 1970 to 2100
  std::string d;
  std::string_view rest = text;
  const bool has_all = cut_digits(rest, 4, "", d) && cut_digits(rest, 2, kBetween, d) &&
                       cut_digits(rest, 2, kBetween, d) && cut_digits(rest, 2, kBeforeTime, d) &&
                       cut_digits(rest, 2, kBetween, d) && cut_digits(rest, 2, kBetween, d);
  if (!has_all) return std::nullopt;
  std::string_view behind = rest;
  std::string milliseconds;
  const auto ends = [](std::string_view at) { return at.empty() || !is_digit(at.front()); };
  if (cut_digits(behind, 3, kBetween, milliseconds) && ends(behind)) {
    rest = behind;
  } else {
    milliseconds = "000";
  }
  if (!ends(rest)) return std::nullopt;
  const std::string_view n = d;
  const std::optional<double> time_s =
      date_time_s(fmt::format("{}.{}.{} {}.{}.{}.{}", n.substr(0, 4), n.substr(4, 2), n.substr(6, 2), n.substr(8, 2),
                              n.substr(10, 2), n.substr(12, 2), milliseconds));
  if (!time_s || !(*time_s >= kFirst_s && *time_s < kLast_s)) return std::nullopt;
  text = rest;
  return time_s;
}

}  // namespace

std::optional<double> date_in_name(std::string_view path) {
  path.remove_prefix(path.find_last_of("/\\") + 1);  // npos + 1 is 0
  std::optional<double> found;
  while (!path.empty()) {
    const std::optional<double> date_s = cut_date(path);
    if (date_s) {
      if (found && *found != *date_s) return std::nullopt;
      found = date_s;
      continue;
    }
    // The next number.
    path.remove_prefix(static_cast<std::size_t>(std::ranges::find_if_not(path, is_digit) - path.begin()));
    path.remove_prefix(static_cast<std::size_t>(std::ranges::find_if(path, is_digit) - path.begin()));
  }
  return found;
}

std::vector<TimeZone> time_zones(const TimeSpan& local, const TimeSpan& utc) {
  const double shorter_s = std::min(local.to_s - local.from_s, utc.to_s - utc.from_s);
  std::vector<TimeZone> zones;
  const auto add = [&](double hours) {
    const double shift_s = hours * 3600.0;
    const double both_s = std::min(local.to_s, utc.to_s + shift_s) - std::max(local.from_s, utc.from_s + shift_s);
    if (both_s >= 0.0) zones.push_back({shift_s, shorter_s > 0.0 ? both_s / shorter_s : 1.0});
  };
  for (int hour = -12; hour <= 14; ++hour) add(hour);
  for (const double hours : {-9.5, -3.5, -2.5, 3.5, 4.5, 5.5, 5.75, 6.5, 8.75, 9.5, 10.5, 12.75, 13.75}) add(hours);
  std::ranges::sort(zones, [](const TimeZone& a, const TimeZone& b) {
    return std::pair(-a.share, a.local_from_utc_s) < std::pair(-b.share, b.local_from_utc_s);
  });
  return zones;
}

std::optional<double> local_from_utc_s(const TimeSpan& local, const TimeSpan& utc) {
  constexpr double kMinShare = 0.9, kNextShare = 0.8;
  const std::vector<TimeZone> zones = time_zones(local, utc);
  if (zones.empty() || zones[0].share < kMinShare) return std::nullopt;
  if (zones.size() > 1 && zones[1].share > kNextShare * zones[0].share) return std::nullopt;
  return zones[0].local_from_utc_s;
}

std::string date_text(double time_s) {
  constexpr double kYear2000_s = 946'684'800.0, kYear2100_s = 4'102'444'800.0;
  if (!(time_s >= kYear2000_s && time_s < kYear2100_s)) return "";
  constexpr double kHalf_s = 0.0005;  // of a millisecond: 19:24:38.9999999 is 19:24:39
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::gmtime(static_cast<std::time_t>(time_s + kHalf_s)));
}

}  // namespace pingvox
