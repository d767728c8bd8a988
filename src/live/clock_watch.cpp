#include "live/clock_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pingvox {

void ClockWatch::Lag::add(double lag_s) {
  if (!std::isfinite(lag_s)) return;
  smallest_s = std::min(smallest_s, lag_s);
  ++count;
}

std::vector<ClockWatch::Difference> ClockWatch::update(double now_s) {
  constexpr double kWindow_s = 5.0;
  std::vector<Difference> found;
  if (!from_s_) from_s_ = now_s;
  if (now_s - *from_s_ < kWindow_s) return found;
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    if (const std::optional<double> ahead_s = judge(devices_[i])) found.push_back({i, *ahead_s});
    devices_[i].lag = {};
  }
  beams_ = {};
  from_s_ = now_s;
  return found;
}

/// Looks at the window that ends. @return what to report
std::optional<double> ClockWatch::judge(Device& device) const {
  // A ping and its transfer take up to 0.3 s; 0.4 s cost 8 % of the precision where a vehicle turns.
  constexpr double kApart_s = 0.5, kAgrees_s = 0.25;
  constexpr std::size_t kMinBeams = 10, kMinSamples = 2;
  const bool is_known = beams_.count >= kMinBeams && device.lag.count >= kMinSamples;
  const std::optional<double> before_s = std::exchange(device.ahead_s, std::nullopt);
  if (!is_known) return std::nullopt;
  const double ahead_s = beams_.smallest_s - device.lag.smallest_s;
  device.ahead_s = ahead_s;
  if (std::fabs(ahead_s) < kAgrees_s) device.is_reported = false;
  // A single wrong stamp, or a line that stalls, is in one window.
  const auto are_apart = [&](double sign) { return sign * ahead_s > kApart_s && sign * *before_s > kApart_s; };
  if (!before_s || !(are_apart(1.0) || are_apart(-1.0))) return std::nullopt;
  if (std::exchange(device.is_reported, true)) return std::nullopt;
  return ahead_s;
}

void ClockWatch::restart(double now_s) {
  beams_ = {};
  for (Device& device : devices_) {
    device.lag = {};
    device.ahead_s.reset();
  }
  from_s_ = now_s;
}

}  // namespace pingvox
