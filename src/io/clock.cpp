#include "pingvox/io/clock.hpp"

#include <fmt/core.h>

#include <string>

#include "io/date.hpp"

namespace pingvox {

std::optional<double> date_in_name(std::string_view path) {
  constexpr std::size_t kDateAndTime = 14, kWithMilliseconds = 17;
  path.remove_prefix(path.find_last_of("/\\") + 1);  // npos + 1 is 0
  std::string digits;
  for (const char c : path) {
    if (c >= '0' && c <= '9') {
      digits += c;
    } else if (std::string_view("-_ ").find(c) == std::string_view::npos) {
      break;
    }
  }
  if (digits.size() != kDateAndTime && digits.size() != kWithMilliseconds) return std::nullopt;
  digits.resize(kWithMilliseconds, '0');
  const std::string_view d = digits;
  return date_time_s(fmt::format("{}.{}.{} {}.{}.{}.{}", d.substr(0, 4), d.substr(4, 2), d.substr(6, 2), d.substr(8, 2),
                                 d.substr(10, 2), d.substr(12, 2), d.substr(14)));
}

std::optional<double> local_from_utc_s(const TimeSpan& local, const TimeSpan& utc) {
  constexpr int kWest = 12 * 4, kEast = 14 * 4;
  constexpr double kQuarter_s = 900.0;
  std::optional<double> found;
  for (int quarter = -kWest; quarter <= kEast; ++quarter) {
    const double shift_s = quarter * kQuarter_s;
    if (utc.from_s + shift_s > local.to_s || utc.to_s + shift_s < local.from_s) continue;
    if (found) return std::nullopt;
    found = shift_s;
  }
  return found;
}

}  // namespace pingvox
