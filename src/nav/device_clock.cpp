#include "pingvox/nav/device_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

namespace pingvox {
namespace {

constexpr double kMinute_s = 60.0;

double difference_s(const DeviceTime& time) {
  return time.received_s - time.made_s;
}

/// Messages may overtake each other.
constexpr double kBack_s = 1.0;

bool was_clock_set(const DeviceTime& before, const DeviceTime& now) {
  constexpr double kJump_s = 60.0;
  return now.made_s < before.made_s - kBack_s || std::fabs(difference_s(now) - difference_s(before)) > kJump_s;
}

}  // namespace

bool was_restarted(const DeviceTime& before, const DeviceTime& now) {
  constexpr double kDelay_s = 10.0;
  return now.made_s < before.made_s - kBack_s && now.made_s <= now.received_s - before.received_s + kDelay_s;
}

double DeviceClock::add(const DeviceTime& time) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const double minute = std::floor(time.received_s / kMinute_s);
  if (!last_ || was_clock_set(*last_, time)) {
    smallest_s_ = smallest_before_s_ = kNone;
  } else if (minute != minute_) {
    smallest_before_s_ = minute == minute_ + 1.0 ? smallest_s_ : kNone;
    smallest_s_ = kNone;
  }
  minute_ = minute;
  last_ = time;
  smallest_s_ = std::min(smallest_s_, difference_s(time));
  return time.made_s + std::min(smallest_s_, smallest_before_s_);
}

std::vector<double> device_times_s(std::span<const DeviceTime> times) {
  using Minute = std::pair<std::size_t, double>;  // times that the clock was set before it, and its number
  std::map<Minute, double> smallest_s;
  std::vector<Minute> minutes;
  std::size_t times_set = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i > 0 && was_clock_set(times[i - 1], times[i])) ++times_set;
    minutes.emplace_back(times_set, std::floor(times[i].received_s / kMinute_s));
    const auto [smallest, is_new] = smallest_s.try_emplace(minutes.back(), difference_s(times[i]));
    if (!is_new) smallest->second = std::min(smallest->second, difference_s(times[i]));
  }
  std::vector<double> made_s;
  for (std::size_t i = 0; i < times.size(); ++i) {
    double nearest_s = smallest_s.at(minutes[i]);
    for (const double beside : {-1.0, 1.0}) {
      const auto other = smallest_s.find({minutes[i].first, minutes[i].second + beside});
      if (other != smallest_s.end()) nearest_s = std::min(nearest_s, other->second);
    }
    made_s.push_back(times[i].made_s + nearest_s);
  }
  return made_s;
}

std::vector<DeviceRun> device_runs(std::span<const DeviceTime> times) {
  constexpr double kSmallestDelay_s = 0.005;
  const std::vector<double> times_s = device_times_s(times);
  std::vector<DeviceRun> runs;
  for (std::size_t first = 0; first < times.size();) {
    std::size_t end = first + 1;
    while (end < times.size() && !was_clock_set(times[end - 1], times[end])) ++end;
    // Differences to the first one, as dates have no digits left for squares.
    const double first_zero_s = times_s[first] - times[first].made_s, count = static_cast<double>(end - first);
    double sum_s = 0.0, squares = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const double more_s = times_s[i] - times[i].made_s - first_zero_s;
      sum_s += more_s;
      squares += more_s * more_s;
    }
    const double mean_s = sum_s / count, variance = std::max(0.0, squares / count - mean_s * mean_s);
    const auto [from, to] = std::minmax_element(times_s.begin() + static_cast<std::ptrdiff_t>(first),
                                                times_s.begin() + static_cast<std::ptrdiff_t>(end));
    runs.push_back({first_zero_s + mean_s, std::hypot(std::sqrt(variance), kSmallestDelay_s), *from, *to});
    first = end;
  }
  return runs;
}

}  // namespace pingvox
