#include <algorithm>
#include <cstddef>
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

class TlogNav {
 public:
  void add(const TlogRecord& record) {
    for (const MavlinkNav::Report& report : nav_.add(record.frame, static_cast<double>(record.time_us) * 1e-6)) {
      const bool is_taken = sources_.add(report.source, report.quantity, report.sample) != nullptr;
      if (is_taken) made_[{report.source, report.quantity}].push_back(made_of(report));
    }
  }

  /// Times are estimated from the whole log.
  std::vector<NavSource> finish() {
    std::map<MavlinkNav::Sender, std::vector<double>> times_s;
    for (const auto& [sender, times] : times_) times_s[sender] = device_times_s(times);
    std::vector<NavSource> sources = sources_.take();
    for (NavSource& source : sources) {
      const auto& made = made_.at({source.name, source.quantity});
      for (std::size_t i = 0; i < source.samples.size(); ++i) {
        if (made[i]) source.samples[i].time_s = times_s.at(made[i]->sender)[made[i]->place];
      }
    }
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

  MavlinkNav nav_;
  NavSources sources_;
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
  reading.sources = nav.finish();
  return reading;
}

}  // namespace pingvox
