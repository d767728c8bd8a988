#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/nav_readers.hpp"
#include "io/nav_sources.hpp"
#include "io/tlog.hpp"
#include "pingvox/io/mavlink_nav.hpp"

// The navigation in the telemetry log of a ground station.
namespace pingvox {
namespace {

class TlogNav {
 public:
  void add(const TlogRecord& record) {
    for (const MavlinkNav::Report& report : nav_.add(record.frame, static_cast<double>(record.time_us) * 1e-6)) {
      const bool is_taken = sources_.add(report.source, report.quantity, report.sample) != nullptr;
      if (is_taken) made_[{report.source, report.quantity}].push_back(report.made);
    }
  }

  /// Times are estimated from the whole log.
  std::vector<NavSource> finish() {
    std::vector<NavSource> sources = sources_.take();
    for (NavSource& source : sources) {
      const auto& made = made_.at({source.name, source.quantity});
      for (std::size_t i = 0; i < source.samples.size(); ++i) {
        if (made[i]) source.samples[i].time_s = nav_.time_s(*made[i]);
      }
    }
    return sources;
  }

 private:
  MavlinkNav nav_;
  NavSources sources_;
  std::map<std::pair<std::string, NavQuantity>, std::vector<std::optional<MavlinkNav::SinceBoot>>> made_;
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
