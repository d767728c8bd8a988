#include "io/nav/mavlink_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace pingvox {
namespace {

constexpr double kUnknownTime_s = std::numeric_limits<double>::quiet_NaN();

/// By which of several clocks each message of a sender was made. Two vehicles with the same address take turns; one
/// that restarts does not go back to its clock of before.
struct Clocks {
  std::vector<std::size_t> of;      ///< number of the clock of each message
  std::vector<std::size_t> counts;  ///< messages of each clock
  std::size_t returns = 0;          ///< to a clock after messages of another one

  explicit Clocks(const std::vector<DeviceTime>& times) {
    constexpr double kSame_s = 5.0;  // delays of a radio vary
    constexpr std::size_t kMaxClocks = 64;
    std::vector<double> differences_s;
    for (const DeviceTime& time : times) {
      const double difference_s = time.received_s - time.made_s;
      const auto same = std::ranges::find_if(
          differences_s, [&](double known_s) { return std::abs(known_s - difference_s) <= kSame_s; });
      const bool is_new = same == differences_s.end() && differences_s.size() < kMaxClocks;
      const auto clock = std::min(static_cast<std::size_t>(same - differences_s.begin()), kMaxClocks - 1);
      if (is_new) {
        differences_s.push_back(difference_s);
        counts.push_back(0);
      } else {
        differences_s[clock] = difference_s;  // clocks drift
        returns += clock != of.back() ? 1 : 0;
      }
      ++counts[clock];
      of.push_back(clock);
    }
  }

  /// Whether they are those of several devices. A clock that is set now and then is not.
  bool are_of_several() const { return returns > 20; }
  std::size_t most_used() const { return static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin()); }
};

}  // namespace

void MavlinkLog::add(const MavlinkFrame& frame, double received_s) {
  const std::uint8_t system = frame.system;
  if (MavlinkNav::is_of_vehicle(frame)) ++frames_of_vehicles_[system];
  const std::size_t place = messages_.size();
  messages_.push_back({received_s, std::nullopt});
  for (const MavlinkNav::Report& report : nav_.add(frame, received_s)) {
    const bool is_taken = sources_.add(report.source, report.quantity, report.sample) != nullptr;
    if (!is_taken) continue;
    origins_[{report.source, report.quantity}].push_back({place, timed_of(report, place)});
    senders_[report.source] = {system, frame.component};
  }
}

void MavlinkLog::finish(NavReading& reading) {
  reading.sources = sources_.take();
  leave_out_other_systems(reading);
  std::map<MavlinkNav::Sender, Places> own;
  for (const auto& [sender, timed] : timed_) own[sender] = places_of_one_device(sender, timed, reading);
  const ReceiverTimes received = receiver_times(messages_of_one_device(own));
  for (const auto& [sender, places] : own) find_times(sender, places, received, reading);
  for (NavSource& source : reading.sources) set_times(source, received);
  std::erase_if(reading.sources, [](NavSource& source) {
    std::erase_if(source.samples, [](const NavSample& sample) { return !std::isfinite(sample.time_s); });
    return source.samples.empty();
  });
  reading.settings = received.settings;
}

std::optional<MavlinkLog::Made> MavlinkLog::timed_of(const MavlinkNav::Report& report, std::size_t message) {
  if (!report.made) return std::nullopt;
  std::vector<Timed>& timed = timed_[report.made->sender];
  timed.push_back({message, report.made->time.made_s});
  return Made{report.made->sender, timed.size() - 1};
}

void MavlinkLog::leave_out_other_systems(NavReading& reading) {
  if (frames_of_vehicles_.size() < 2) return;
  const auto vehicle =
      std::ranges::max_element(frames_of_vehicles_, {}, [](const auto& frames) { return frames.second; });
  std::string others;
  for (const auto& [system, frames] : frames_of_vehicles_) {
    if (system == vehicle->first) continue;
    others += fmt::format("{}{} ({} messages)", others.empty() ? "" : ", ", system, frames);
  }
  reading.notes.push_back(fmt::format("holds several vehicles: system {} ({} messages) is read, left out: system {}",
                                      vehicle->first, vehicle->second, others));
  const auto is_other = [&](const MavlinkNav::Sender& sender) {
    return sender.first != vehicle->first && frames_of_vehicles_.contains(sender.first);
  };
  std::erase_if(reading.sources, [&](const NavSource& source) { return is_other(senders_.at(source.name)); });
  std::erase_if(timed_, [&](const auto& timed) { return is_other(timed.first); });
}

/// The messages of the device that sent most of them, where several have one address.
MavlinkLog::Places MavlinkLog::places_of_one_device(const MavlinkNav::Sender& sender, const std::vector<Timed>& timed,
                                                    NavReading& reading) {
  std::vector<DeviceTime> times;
  for (const Timed& t : timed) times.push_back({messages_[t.message].received_s, t.made_s});
  const Clocks clocks(times);
  const bool are_of_several = clocks.are_of_several();
  const std::size_t most_used = clocks.most_used();
  Places places;
  for (std::size_t i = 0; i < timed.size(); ++i) {
    if (!are_of_several || clocks.of[i] == most_used) places.push_back(i);
  }
  if (!are_of_several) return places;
  reading.notes.push_back(fmt::format(
      "holds several vehicles with the same address, system {}, which were switched on at different times: {} "
      "samples of one are read, left out: {} of others, and messages without a time",
      sender.first, places.size(), timed.size() - places.size()));
  shared_.push_back(sender);
  return places;
}

/// With the times of the sender that says most of them.
std::vector<ReceivedMessage> MavlinkLog::messages_of_one_device(const std::map<MavlinkNav::Sender, Places>& own) const {
  std::vector<ReceivedMessage> messages = messages_;
  const auto most = std::ranges::max_element(own, {}, [](const auto& places) { return places.second.size(); });
  if (most == own.end()) return messages;
  const std::vector<Timed>& timed = timed_.at(most->first);
  for (const std::size_t place : most->second) messages[timed[place].message].made_s = timed[place].made_s;
  return messages;
}

/// Finds when the messages of a sender were made; the time of others with its address stays unknown.
void MavlinkLog::find_times(const MavlinkNav::Sender& sender, const Places& places, const ReceiverTimes& received,
                            NavReading& reading) {
  const std::vector<Timed>& timed = timed_.at(sender);
  std::vector<DeviceTime> times;
  for (const std::size_t place : places) times.push_back({received.times_s[timed[place].message], timed[place].made_s});
  const std::vector<double> found_s = device_times_s(times);
  std::vector<double>& made_s = made_s_[sender];
  made_s.assign(timed.size(), kUnknownTime_s);
  for (std::size_t i = 0; i < places.size(); ++i) made_s[places[i]] = found_s[i];
  if (sender.second == kAutopilot) std::ranges::move(device_runs(times), std::back_inserter(reading.runs));
}

/// Where several devices share an address, whose messages without a time are is not known.
void MavlinkLog::set_times(NavSource& source, const ReceiverTimes& received) const {
  const std::vector<Origin>& origins = origins_.at({source.name, source.quantity});
  const bool is_shared = std::ranges::find(shared_, senders_.at(source.name)) != shared_.end();
  for (std::size_t i = 0; i < source.samples.size(); ++i) {
    const auto& [message, made] = origins[i];
    double& time_s = source.samples[i].time_s;
    if (made) {
      time_s = made_s_.at(made->sender)[made->place];
    } else {
      time_s = is_shared ? kUnknownTime_s : time_s + received.times_s[message] - messages_[message].received_s;
    }
  }
}

}  // namespace pingvox
