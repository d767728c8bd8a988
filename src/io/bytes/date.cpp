#include "io/bytes/date.hpp"

#include <fmt/core.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace pingvox {
namespace {

/// Parses the numbers of a text of a form such as "0000.00": each 0 is a digit, other characters are literal. nullopt:
/// it does not match.
template <std::size_t N>
std::optional<std::array<int, N>> numbers_in(std::string_view text, std::string_view form) {
  if (text.size() != form.size()) return std::nullopt;
  std::array<int, N> numbers = {};
  std::size_t number = 0;
  for (std::size_t i = 0; i < form.size(); ++i) {
    if (form[i] == '0') {
      if (text[i] < '0' || text[i] > '9') return std::nullopt;
      numbers[number] = numbers[number] * 10 + (text[i] - '0');
    } else {
      if (text[i] != form[i]) return std::nullopt;
      ++number;
    }
  }
  return numbers;
}

std::optional<double> seconds_of(int hour, int minute, int second, int millisecond) {
  // 60 is a leap second.
  if (hour > 23 || minute > 59 || second > 60) return std::nullopt;
  return (hour * 60 + minute) * 60 + second + millisecond / 1000.0;
}

}  // namespace

std::optional<double> date_time_s(std::string_view text) {
  const auto numbers = numbers_in<7>(text, "0000.00.00 00.00.00.000");
  if (!numbers) return std::nullopt;
  const auto& [year, month, day, hour, minute, second, millisecond] = *numbers;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  const std::optional<double> time_s = seconds_of(hour, minute, second, millisecond);
  if (!date.ok() || !time_s) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count()) * 86400.0 + *time_s;
}

std::string date_time_text(std::uint64_t since_1970_ms) {
  using std::chrono::days;
  const std::chrono::milliseconds since(since_1970_ms);
  const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::floor<days>(since))};
  const std::chrono::hh_mm_ss time(since - std::chrono::floor<days>(since));
  return fmt::format("{:04}.{:02}.{:02} {:02}.{:02}.{:02}.{:03}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), time.hours().count(),
                     time.minutes().count(), time.seconds().count(), time.subseconds().count());
}

std::optional<double> time_of_day_s(std::string_view text) {
  const auto numbers = numbers_in<4>(text, "00:00:00.000");
  if (!numbers) return std::nullopt;
  const auto& [hour, minute, second, millisecond] = *numbers;
  return seconds_of(hour, minute, second, millisecond);
}

}  // namespace pingvox
