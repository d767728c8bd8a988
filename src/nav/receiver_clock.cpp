#include "pingvox/nav/receiver_clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pingvox {
namespace {

/// Records of one program are in the order of their times, and devices send theirs in order.
constexpr double kOutOfOrder_s = 1.0;
/// A clock of a computer is not off by less for long; delays are hardly longer.
constexpr double kAhead_s = 2.0;
/// Delays of a message that waited in a queue are shorter.
constexpr double kLongestDelay_s = 60.0;

using Messages = std::span<const ReceivedMessage>;

/// A message before which the clock may have been set.
struct ClockSettingCandidate {
  std::size_t first;     ///< with the new time
  bool is_sure = false;  ///< delays do not explain it
};

bool is_sure_setting(double before_s, double after_s) {
  const bool is_first_date = before_s < kFirstDate_s && after_s >= kFirstDate_s;
  return after_s < before_s - kOutOfOrder_s || (is_first_date && after_s - before_s > kLongestDelay_s);
}

/// The one of the messages after `from`, up to `to`, whose time is the farthest from that before it.
std::size_t longest_step(Messages messages, std::size_t from, std::size_t to) {
  std::size_t longest = to;
  for (std::size_t i = from + 1; i <= to; ++i) {
    const auto step_s = [&](std::size_t at) { return messages[at].received_s - messages[at - 1].received_s; };
    if (step_s(i) > step_s(longest)) longest = i;
  }
  return longest;
}

std::vector<ClockSettingCandidate> candidates_in(Messages messages) {
  std::vector<ClockSettingCandidate> found;
  std::optional<std::size_t> last;  // of the device
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (i > 0 && is_sure_setting(messages[i - 1].received_s, messages[i].received_s)) found.push_back({i, true});
    if (!messages[i].made_s) continue;
    if (last) {
      const double made_s = *messages[i].made_s - *messages[*last].made_s;
      const double received_s = messages[i].received_s - messages[*last].received_s;
      if (made_s >= -kOutOfOrder_s && received_s - made_s > kAhead_s) {
        found.push_back({longest_step(messages, *last, i), false});
      }
    }
    last = i;
  }
  std::ranges::sort(found, [](const ClockSettingCandidate& a, const ClockSettingCandidate& b) {
    return a.first != b.first ? a.first < b.first : a.is_sure && !b.is_sure;
  });
  const auto again = std::ranges::unique(found, {}, &ClockSettingCandidate::first);
  found.erase(again.begin(), again.end());
  return found;
}

/// Messages of the device in a minute of its clock.
struct Delays {
  double smallest_s = std::numeric_limits<double>::infinity();  ///< what the recorder's clock says more
  double nearest_s = 0.0;                                       ///< time of the device at the setting
  double lasts_s = 0.0;

  bool has_any() const { return std::isfinite(smallest_s); }
  /// @return false beyond the minute, and where the device restarted
  bool add(const ReceivedMessage& message, double sense) {
    if (!message.made_s) return true;
    if (!has_any()) nearest_s = *message.made_s;
    const double from_setting_s = sense * (*message.made_s - nearest_s);
    if (from_setting_s > kLongestDelay_s || from_setting_s < lasts_s - kOutOfOrder_s) return false;
    lasts_s = std::max(lasts_s, from_setting_s);
    smallest_s = std::min(smallest_s, message.received_s - *message.made_s);
    return true;
  }
};

/// @param from  the first message after the setting before
Delays delays_before(Messages messages, std::size_t first, std::size_t from) {
  Delays delays;
  for (std::size_t i = first; i > from && delays.add(messages[i - 1], -1.0); --i) {
  }
  return delays;
}

Delays delays_after(Messages messages, std::size_t first) {
  Delays delays;
  for (std::size_t i = first; i < messages.size() && delays.add(messages[i], 1.0); ++i) {
    const bool is_set_again =
        i + 1 < messages.size() && is_sure_setting(messages[i].received_s, messages[i + 1].received_s);
    if (is_set_again) break;
  }
  return delays;
}

struct Setting {
  std::size_t first;           ///< message with the new time
  std::optional<double> by_s;  ///< nullopt: not known
};

/// nullopt: the clock was not set there.
std::optional<Setting> setting_at(Messages messages, const ClockSettingCandidate& candidate, std::size_t from) {
  constexpr double kStays_s = 20.0;
  const Delays before = delays_before(messages, candidate.first, from), after = delays_after(messages, candidate.first);
  const bool is_determined = before.has_any() && after.has_any() && after.nearest_s >= before.nearest_s - kOutOfOrder_s;
  if (!is_determined) return candidate.is_sure ? std::optional(Setting{candidate.first, std::nullopt}) : std::nullopt;
  const double by_s = after.smallest_s - before.smallest_s;
  const bool is_ahead = by_s > kLongestDelay_s || (by_s > kAhead_s && after.lasts_s >= kStays_s);
  const bool was_set = is_ahead || (candidate.is_sure && std::abs(by_s) > kOutOfOrder_s);
  return was_set ? std::optional(Setting{candidate.first, by_s}) : std::nullopt;
}

std::vector<Setting> settings_in(Messages messages) {
  std::vector<Setting> settings;
  for (const ClockSettingCandidate& candidate : candidates_in(messages)) {
    const auto setting = setting_at(messages, candidate, settings.empty() ? 0 : settings.back().first);
    if (setting) settings.push_back(*setting);
  }
  return settings;
}

/// Messages between two settings.
struct Part {
  std::size_t first, end;
  double by_s;  ///< what the clock said more than in the first one of those that are on one clock
};

/// Puts parts on the clock of the last one with dates, or of the last one.
void put_on_one_clock(std::span<const Part> parts, std::vector<double>& times_s) {
  const Part* right = &parts.back();
  for (const Part& part : parts) {
    if (times_s[part.first] >= kFirstDate_s || times_s[right->first] < kFirstDate_s) right = &part;
  }
  for (const Part& part : parts) {
    for (std::size_t i = part.first; i < part.end; ++i) times_s[i] += right->by_s - part.by_s;
  }
}

}  // namespace

ReceiverTimes receiver_times(std::span<const ReceivedMessage> messages) {
  ReceiverTimes found;
  for (const ReceivedMessage& message : messages) found.times_s.push_back(message.received_s);
  if (messages.empty()) return found;
  const std::vector<Setting> settings = settings_in(messages);
  std::vector<Part> parts = {{0, messages.size(), 0.0}};
  for (const Setting& setting : settings) {
    parts.back().end = setting.first;
    if (!setting.by_s) {
      put_on_one_clock(parts, found.times_s);
      parts.clear();
    }
    const double before_s = parts.empty() ? 0.0 : parts.back().by_s;
    parts.push_back({setting.first, messages.size(), before_s + setting.by_s.value_or(0.0)});
  }
  put_on_one_clock(parts, found.times_s);
  for (const Setting& setting : settings) found.settings.push_back({found.times_s[setting.first], setting.by_s});
  return found;
}

}  // namespace pingvox
