#include "io/nav/tlog.hpp"

#include <algorithm>
#include <bit>
#include <optional>

#include "io/bytes/byte_reader.hpp"
#include "io/internal/frame_finder.hpp"

namespace pingvox {
namespace {

constexpr std::size_t kTimeBytes = 8;
constexpr std::uint64_t kYear2005_us = 1'104'537'600'000'000, kYear2100_us = 4'102'444'800'000'000;
constexpr std::uint64_t kMinute_us = 60'000'000;

/// The time in front of a possible record. A computer without a clock starts in 1970, 1980 or 2000.
std::optional<std::uint64_t> time_at(std::span<const std::uint8_t> bytes) {
  if (bytes.size() <= kTimeBytes || (bytes[kTimeBytes] != 0xfe && bytes[kTimeBytes] != 0xfd)) return std::nullopt;
  const auto time_us = value_from<std::uint64_t>(bytes.first(kTimeBytes), std::endian::big);
  if (time_us == 0 || time_us > kYear2100_us) return std::nullopt;
  return time_us;
}

/// Whether it may be a date of a clock that was set: there were no such logs before.
bool is_date(std::uint64_t time_us) {
  return time_us >= kYear2005_us;
}

std::uint64_t difference(std::uint64_t a, std::uint64_t b) {
  return a > b ? a - b : b - a;
}

/// Whether a record may follow here: the end of the file may too.
bool may_follow(std::span<const std::uint8_t> bytes, std::uint64_t before_us) {
  if (bytes.size() <= kTimeBytes) return true;
  const std::optional<std::uint64_t> time_us = time_at(bytes);
  return time_us && difference(*time_us, before_us) <= kMinute_us;
}

bool is_right(const MavlinkFrame& frame) {
  using Check = MavlinkFrame::Check;
  return frame.check == Check::kRight || frame.check == Check::kRightPadded;
}

/// Whether records from here on, each at most a minute after the one before, lead to one with a right checksum or to
/// the end of the file.
bool leads_to_right_record(std::span<const std::uint8_t> bytes, std::uint64_t before_us) {
  constexpr int kMaxRecords = 64;
  for (int i = 0; i < kMaxRecords; ++i) {
    if (!may_follow(bytes, before_us)) return false;
    if (bytes.size() <= kTimeBytes) return true;
    before_us = *time_at(bytes);
    const MavlinkRead read = read_mavlink(bytes.subspan(kTimeBytes));
    if (!read.frame) return read.is_cut;
    if (is_right(*read.frame)) return true;
    bytes = bytes.subspan(kTimeBytes + read.length);
  }
  return false;
}

/// Whether bytes that look like a frame, but whose checksum is wrong or unknown, are a record: others follow.
/// @param rest       what is behind it
/// @param latest_us  time of the record before it
bool is_between_records(std::uint64_t time_us, std::optional<std::uint64_t> latest_us,
                        std::span<const std::uint8_t> rest) {
  const bool is_likely = is_date(time_us) || (latest_us && difference(time_us, *latest_us) <= kMinute_us);
  return is_likely ? may_follow(rest, time_us) : leads_to_right_record(rest, time_us);
}

/// Whether a time is far from those before and after it, which agree: a wrong bit, not a clock that was set.
bool is_alone(std::uint64_t before_us, std::uint64_t time_us, std::uint64_t after_us) {
  constexpr std::uint64_t kFar_us = 1'000'000;
  return difference(before_us, after_us) <= kFar_us && difference(before_us, time_us) > kFar_us &&
         difference(time_us, after_us) > kFar_us;
}

/// Whether a time is none of a clock that was set, and far from those before and after it.
bool is_undated_alone(std::optional<std::uint64_t> before_us, std::uint64_t time_us,
                      std::optional<std::uint64_t> after_us) {
  const auto is_far = [&](std::optional<std::uint64_t> other_us) {
    return !other_us || difference(*other_us, time_us) > kMinute_us;
  };
  return !is_date(time_us) && (before_us || after_us) && is_far(before_us) && is_far(after_us);
}

/// A record whose time is judged by that of the next one.
struct HeldRecord {
  TlogRecord record;
  std::size_t at;  ///< in the file
};

}  // namespace

std::size_t for_each_tlog_record(std::span<const std::uint8_t> bytes, std::vector<DamageKind>& damage,
                                 const std::function<void(const TlogRecord&)>& take) {
  using Check = MavlinkFrame::Check;
  std::size_t records = 0;
  std::size_t at = 0;
  std::size_t stray_from = 0;  ///< the first of the bytes skipped just now
  bool is_stray = false;       ///< whether there are any
  bool is_cut = false;         ///< whether a record that the file ends in began there
  const auto end_of_stray = [&](bool at_end) {
    if (is_stray) add_damage(damage, at_end && is_cut ? "cut off at the end" : "bytes between records", stray_from);
    is_stray = is_cut = false;
  };
  std::optional<std::uint64_t> before_us;  ///< time of the last record that was passed on
  std::optional<HeldRecord> held;
  const auto pass_on = [&](std::optional<std::uint64_t> after_us) {
    if (!held) return;
    const std::uint64_t time_us = held->record.time_us;
    if ((before_us && after_us && is_alone(*before_us, time_us, *after_us)) ||
        is_undated_alone(before_us, time_us, after_us)) {
      add_damage(damage, "wrong time", held->at);
    } else {
      ++records;
      before_us = time_us;
      take(held->record);
    }
    held.reset();
  };
  while (at < bytes.size()) {
    const auto rest = bytes.subspan(at);
    const std::optional<std::uint64_t> time_us = time_at(rest);
    const MavlinkRead read = time_us ? read_mavlink(rest.subspan(kTimeBytes)) : MavlinkRead{};
    const std::size_t length = kTimeBytes + read.length;
    // Without a correct checksum, the bytes that follow decide whether this was a record.
    const std::optional<std::uint64_t> latest_us = held ? held->record.time_us : before_us;
    if (!read.frame || (!is_right(*read.frame) && !is_between_records(*time_us, latest_us, rest.subspan(length)))) {
      if (!is_stray) stray_from = at;
      is_stray = true;
      is_cut = is_cut || read.is_cut || rest.size() <= kTimeBytes;
      ++at;
      continue;
    }
    end_of_stray(false);
    if (read.frame->check == Check::kWrong) {
      add_damage(damage, "wrong checksum", at);
    } else {
      pass_on(time_us);
      held = HeldRecord{{*time_us, *read.frame}, at};
    }
    at += length;
  }
  end_of_stray(true);
  pass_on(std::nullopt);
  // A wrong time is noticed only at the next record, behind damage in between.
  std::ranges::sort(damage, {}, &DamageKind::first_byte);
  return records;
}

}  // namespace pingvox
