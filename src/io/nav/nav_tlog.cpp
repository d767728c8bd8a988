#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/nav/mavlink_log.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/nav/tlog.hpp"

// The navigation in the telemetry log of a ground station.
namespace pingvox {
namespace {

/// Whether frames follow each other without the time between them that a telemetry log has.
bool is_without_times(std::span<const std::uint8_t> bytes) {
  const auto is_right = [](const MavlinkRead& read) {
    return read.frame && read.frame->check == MavlinkFrame::Check::kRight;
  };
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    const MavlinkRead read = read_mavlink(bytes.subspan(at));
    if (is_right(read)) return is_right(read_mavlink(bytes.subspan(at + read.length)));
  }
  return false;
}

}  // namespace

bool looks_like_tlog(std::span<const std::uint8_t> bytes) {
  // A log may begin in the middle of a record, so a record near its beginning suffices.
  constexpr std::size_t kNear = 2048;
  std::vector<DamageKind> damage;
  if (is_without_times(bytes.first(std::min(bytes.size(), kNear)))) return false;
  bool found = false;
  for_each_tlog_record(bytes.first(std::min(bytes.size(), kNear)), damage, [&](const TlogRecord& record) {
    found = found || record.frame.check == MavlinkFrame::Check::kRight;
  });
  return found;
}

NavReading read_tlog(std::span<const std::uint8_t> bytes) {
  NavReading reading;
  reading.clock = NavClock::kUnix;
  MavlinkLog log;
  reading.records = for_each_tlog_record(bytes, reading.damage, [&log](const TlogRecord& record) {
    log.add(record.frame, static_cast<double>(record.time_us) * 1e-6);
  });
  log.finish(reading);
  return reading;
}

}  // namespace pingvox
