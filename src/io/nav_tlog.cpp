#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/nav_readers.hpp"
#include "io/nav_sources.hpp"
#include "io/tlog.hpp"
#include "pingvox/io/mavlink_nav.hpp"
#include "pingvox/nav/device_clock.hpp"

// The navigation in the telemetry log of a ground station.
namespace pingvox {
namespace {

/// By which of several clocks each message of a sender was made. Two vehicles with the same address take turns; one
/// that is started anew does not go back to its clock of before.
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

class TlogNav {
 public:
  void add(const TlogRecord& record) {
    const std::uint8_t system = record.frame.system;
    if (MavlinkNav::is_of_vehicle(record.frame)) ++frames_of_vehicles_[system];
    for (const MavlinkNav::Report& report : nav_.add(record.frame, static_cast<double>(record.time_us) * 1e-6)) {
      const bool is_taken = sources_.add(report.source, report.quantity, report.sample) != nullptr;
      if (!is_taken) continue;
      made_[{report.source, report.quantity}].push_back(made_of(report));
      senders_[report.source] = {system, record.frame.component};
    }
  }

  /// Times are estimated from the whole log. Of several vehicles the one with the most messages is read.
  /// @param notes  gets what was left out
  std::vector<NavSource> finish(std::vector<std::string>& notes) {
    std::vector<NavSource> sources = sources_.take();
    leave_out_other_systems(sources, notes);
    std::map<MavlinkNav::Sender, std::vector<double>> times_s;
    for (const auto& [sender, times] : times_) times_s[sender] = times_of(sender, times, sources, notes);
    for (NavSource& source : sources) {
      const auto& made = made_.at({source.name, source.quantity});
      for (std::size_t i = 0; i < source.samples.size(); ++i) {
        if (made[i]) source.samples[i].time_s = times_s.at(made[i]->sender)[made[i]->place];
      }
    }
    std::erase_if(sources, [](NavSource& source) {
      std::erase_if(source.samples, [](const NavSample& sample) { return !std::isfinite(sample.time_s); });
      return source.samples.empty();
    });
    return sources;
  }

 private:
  /// Where the time of a message is in `times_`.
  struct Made {
    MavlinkNav::Sender sender;
    std::size_t place;
  };

  std::optional<Made> made_of(const MavlinkNav::Report& report) {
    if (!report.made) return std::nullopt;
    std::vector<DeviceTime>& times = times_[report.made->sender];
    times.push_back(report.made->time);
    return Made{report.made->sender, times.size() - 1};
  }

  void leave_out_other_systems(std::vector<NavSource>& sources, std::vector<std::string>& notes) const {
    if (frames_of_vehicles_.size() < 2) return;
    const auto vehicle =
        std::ranges::max_element(frames_of_vehicles_, {}, [](const auto& frames) { return frames.second; });
    std::string others;
    for (const auto& [system, frames] : frames_of_vehicles_) {
      if (system == vehicle->first) continue;
      others += fmt::format("{}{} ({} messages)", others.empty() ? "" : ", ", system, frames);
    }
    notes.push_back(fmt::format("holds several vehicles: system {} ({} messages) is read, left out: system {}",
                                vehicle->first, vehicle->second, others));
    std::erase_if(sources, [&](const NavSource& source) {
      const std::uint8_t system = senders_.at(source.name).first;
      return system != vehicle->first && frames_of_vehicles_.contains(system);
    });
  }

  /// Times of the messages of a sender. Not a number: of another vehicle with the same address.
  std::vector<double> times_of(const MavlinkNav::Sender& sender, const std::vector<DeviceTime>& times,
                               std::vector<NavSource>& sources, std::vector<std::string>& notes) const {
    const Clocks clocks(times);
    if (!clocks.are_of_several()) return device_times_s(times);
    const std::size_t vehicle = clocks.most_used();
    std::vector<DeviceTime> own;
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (clocks.of[i] == vehicle) own.push_back(times[i]);
    }
    const std::vector<double> own_s = device_times_s(own);
    std::vector<double> times_s(times.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0, next = 0; i < times.size(); ++i) {
      if (clocks.of[i] == vehicle) times_s[i] = own_s[next++];
    }
    notes.push_back(fmt::format(
        "holds several vehicles with the same address, system {}, which were switched on at different times: {} "
        "samples of one are read, left out: {} of others, and those of messages that do not tell their time",
        sender.first, own.size(), times.size() - own.size()));
    leave_out_messages_without_time(sender, sources);
    return times_s;
  }

  /// Whose they are cannot be told.
  void leave_out_messages_without_time(const MavlinkNav::Sender& sender, std::vector<NavSource>& sources) const {
    for (NavSource& source : sources) {
      if (senders_.at(source.name) != sender) continue;
      const auto& made = made_.at({source.name, source.quantity});
      for (std::size_t i = 0; i < source.samples.size(); ++i) {
        if (!made[i]) source.samples[i].time_s = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }

  MavlinkNav nav_;
  NavSources sources_;
  std::map<std::uint8_t, std::size_t> frames_of_vehicles_;  ///< with navigation, by system
  std::map<std::string, MavlinkNav::Sender> senders_;       ///< of each source
  std::map<MavlinkNav::Sender, std::vector<DeviceTime>> times_;
  std::map<std::pair<std::string, NavQuantity>, std::vector<std::optional<Made>>> made_;  ///< of each sample
};

}  // namespace

bool looks_like_tlog(std::span<const std::uint8_t> bytes) {
  // A log may begin in the middle of a record, so a record near its beginning suffices.
  constexpr std::size_t kNear = 2048;
  std::vector<DamageKind> damage;
  bool found = false;
  for_each_tlog_record(bytes.first(std::min(bytes.size(), kNear)), damage, [&](const TlogRecord& record) {
    found = found || record.frame.check == MavlinkFrame::Check::kRight;
  });
  return found;
}

NavReading read_tlog(std::span<const std::uint8_t> bytes) {
  NavReading reading;
  reading.clock = NavClock::kUnix;
  TlogNav nav;
  reading.records = for_each_tlog_record(bytes, reading.damage, [&nav](const TlogRecord& record) { nav.add(record); });
  reading.sources = nav.finish(reading.notes);
  return reading;
}

}  // namespace pingvox
