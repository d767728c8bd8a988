#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/byte_reader.hpp"
#include "io/nav_readers.hpp"
#include "io/nav_sources.hpp"
#include "io/tlog.hpp"

// The navigation in the telemetry log of a ground station.
namespace pingvox {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// When a device started, on the clock of whoever recorded it. Delays only add, so the smallest difference of the two
/// clocks is the nearest; a difference that jumps means that the device was started anew.
class BootTimes {
 public:
  /// @return the number of the start that a message belongs to
  std::size_t add(double received_s, double since_boot_s) {
    constexpr double kNewStart_s = 2.0;
    const double offset_s = received_s - since_boot_s;
    if (starts_s_.empty() || std::fabs(offset_s - starts_s_.back()) > kNewStart_s) starts_s_.push_back(offset_s);
    starts_s_.back() = std::min(starts_s_.back(), offset_s);
    return starts_s_.size() - 1;
  }
  double start_s(std::size_t number) const { return starts_s_[number]; }

 private:
  std::vector<double> starts_s_;
};

/// Fields of a payload, by their offset.
class Fields {
 public:
  explicit Fields(const MavlinkFrame& frame) : payload_(frame.payload) {}
  template <class T>
  T at(std::size_t offset) const {
    return value_from<T>(payload_.subspan(offset, sizeof(T)), std::endian::little);
  }
  /// Three numbers, one behind the other.
  template <class T>
  Eigen::Vector3d three(std::size_t offset) const {
    return {static_cast<double>(at<T>(offset)), static_cast<double>(at<T>(offset + sizeof(T))),
            static_cast<double>(at<T>(offset + 2 * sizeof(T)))};
  }

 private:
  std::span<const std::uint8_t> payload_;
};

NavSample sample_of(const Eigen::Vector3d& value) {
  NavSample sample;
  sample.value = value;
  return sample;
}

/// A position of the autopilot's filter, which says 0, 0 as long as nothing tells it where it is.
NavSample position_of(const Eigen::Vector3d& north_east_down) {
  NavSample sample = sample_of(from_ned::world(north_east_down));
  sample.valid = north_east_down.x() != 0.0 || north_east_down.y() != 0.0;
  return sample;
}

/// A fix of integers of 1e-7 degrees; 0, 0 is what a receiver without satellites says.
NavSample fix_of(std::int32_t latitude, std::int32_t longitude, double altitude_m) {
  NavSample sample = sample_of({latitude * 1e-7 * kRadPerDeg, longitude * 1e-7 * kRadPerDeg, altitude_m});
  sample.valid = latitude != 0 || longitude != 0;
  return sample;
}

class TlogNav {
 public:
  void add(const TlogRecord& record) {
    // The autopilot's own messages need no address behind their name.
    const bool is_autopilot = record.frame.system == 1 && record.frame.component == 1;
    sender_ = is_autopilot ? "" : fmt::format(" {}/{}", record.frame.system, record.frame.component);
    time_s_ = static_cast<double>(record.time_us) * 1e-6;
    boot_.reset();
    add_fields(record.frame.message, Fields(record.frame), std::pair{record.frame.system, record.frame.component});
  }

  std::vector<NavSource> finish() {
    std::vector<NavSource> sources = sources_.take();
    for (NavSource& source : sources) {
      const auto stamps = stamps_.find({source.name, source.quantity});
      if (stamps == stamps_.end()) continue;
      for (std::size_t i = 0; i < source.samples.size(); ++i) {
        const Stamp& stamp = stamps->second[i];
        source.samples[i].time_s = boot_times_[stamp.sender].start_s(stamp.start) + stamp.since_boot_s;
      }
    }
    return sources;
  }

 private:
  using Sender = std::pair<std::uint8_t, std::uint8_t>;
  struct Stamp {
    Sender sender;
    std::size_t start;
    double since_boot_s;
  };

  void put(const char* name, NavQuantity quantity, const NavSample& sample) {
    const std::string full = name + sender_;
    NavSample timed = sample;
    timed.time_s = time_s_;
    if (sources_.add(full, quantity, timed) != nullptr && boot_) stamps_[{full, quantity}].push_back(*boot_);
  }

  /// The message says itself when it was made.
  void has_boot_time(const Sender& sender, std::uint32_t boot_ms) {
    const double since_boot_s = boot_ms * 1e-3;
    boot_ = Stamp{sender, boot_times_[sender].add(time_s_, since_boot_s), since_boot_s};
  }

  void add_fields(std::uint32_t message, const Fields& fields, const Sender& sender) {
    using enum NavQuantity;
    switch (message) {
      case 24:
        return put("GPS_RAW_INT", kFix,
                   with_validity(fix_of(fields.at<std::int32_t>(8), fields.at<std::int32_t>(12),
                                        fields.at<std::int32_t>(16) * 1e-3),
                                 fields.at<std::uint8_t>(28) >= 2));
      case 29:
        return add_pressure("SCALED_PRESSURE", fields, sender);
      case 137:
        return add_pressure("SCALED_PRESSURE2", fields, sender);
      case 143:
        return add_pressure("SCALED_PRESSURE3", fields, sender);
      case 30:
        has_boot_time(sender, fields.at<std::uint32_t>(0));
        put("ATTITUDE", kAttitude, sample_of(from_ned::attitude(fields.three<float>(4))));
        return put("ATTITUDE", kTurnRate, sample_of(from_ned::body(fields.three<float>(16))));
      case 31:
        return add_quaternion(fields, sender);
      case 32:
        has_boot_time(sender, fields.at<std::uint32_t>(0));
        return put("LOCAL_POSITION_NED", kPosition, position_of(fields.three<float>(4)));
      case 33:
        has_boot_time(sender, fields.at<std::uint32_t>(0));
        put("GLOBAL_POSITION_INT", kDepth, sample_of({fields.at<std::int32_t>(16) * -1e-3, 0, 0}));
        return put("GLOBAL_POSITION_INT", kFix,
                   fix_of(fields.at<std::int32_t>(4), fields.at<std::int32_t>(8), fields.at<std::int32_t>(12) * 1e-3));
      case 74:
        return put("VFR_HUD", kHeading, sample_of({from_ned::yaw(fields.at<std::int16_t>(16) * kRadPerDeg), 0, 0}));
      case 102:
        put("VISION_POSITION_ESTIMATE", kPosition, sample_of(from_ned::world(fields.three<float>(8))));
        return put("VISION_POSITION_ESTIMATE", kAttitude, sample_of(from_ned::attitude(fields.three<float>(20))));
      case 132:
        return add_distance(fields, sender);
      case 178:
        return put("AHRS2", kAttitude, sample_of(from_ned::attitude(fields.three<float>(0))));
      case 232:
        return put("GPS_INPUT", kFix,
                   with_validity(fix_of(fields.at<std::int32_t>(12), fields.at<std::int32_t>(16), fields.at<float>(20)),
                                 fields.at<std::uint8_t>(61) >= 2));
      case 11011:
        return add_position_delta(fields);
      default:
        return;
    }
  }

  static NavSample with_validity(NavSample sample, bool is_good) {
    sample.valid = sample.valid && is_good;
    return sample;
  }

  void add_pressure(const char* name, const Fields& fields, const Sender& sender) {
    has_boot_time(sender, fields.at<std::uint32_t>(0));
    put(name, NavQuantity::kPressure, sample_of({fields.at<float>(4) * 100.0, 0, 0}));
  }

  void add_quaternion(const Fields& fields, const Sender& sender) {
    has_boot_time(sender, fields.at<std::uint32_t>(0));
    const Eigen::Vector3d xyz = fields.three<float>(8);
    const Eigen::Quaterniond q(fields.at<float>(4), xyz.x(), xyz.y(), xyz.z());
    if (std::fabs(q.norm() - 1.0) <= 1e-3) {
      const Eigen::Matrix3d r = q.normalized().toRotationMatrix();
      const Eigen::Vector3d rpy(std::atan2(r(2, 1), r(2, 2)), std::asin(std::clamp(-r(2, 0), -1.0, 1.0)),
                                std::atan2(r(1, 0), r(0, 0)));
      put("ATTITUDE_QUATERNION", NavQuantity::kAttitude, sample_of(from_ned::attitude(rpy)));
    }
    put("ATTITUDE_QUATERNION", NavQuantity::kTurnRate, sample_of(from_ned::body(fields.three<float>(20))));
  }

  void add_distance(const Fields& fields, const Sender& sender) {
    has_boot_time(sender, fields.at<std::uint32_t>(0));
    const auto least_cm = fields.at<std::uint16_t>(4), most_cm = fields.at<std::uint16_t>(6);
    const auto now_cm = fields.at<std::uint16_t>(8);
    const NavSample sample = with_validity(sample_of({now_cm * 0.01, 0, 0}), now_cm >= least_cm && now_cm <= most_cm);
    put("DISTANCE_SENSOR", NavQuantity::kRange, sample);
  }

  /// How far the vehicle moved in the time before: the velocity in the middle of it.
  void add_position_delta(const Fields& fields) {
    const double step_s = static_cast<double>(fields.at<std::uint64_t>(8)) * 1e-6;
    if (!(step_s > 0.0)) return;
    time_s_ -= step_s / 2.0;
    put("VISION_POSITION_DELTA", NavQuantity::kVelocity, sample_of(from_ned::body(fields.three<float>(28)) / step_s));
  }

  NavSources sources_;
  std::string sender_;
  double time_s_ = 0.0;
  std::optional<Stamp> boot_;
  std::map<Sender, BootTimes> boot_times_;
  std::map<std::pair<std::string, NavQuantity>, std::vector<Stamp>> stamps_;
};

}  // namespace

bool looks_like_tlog(std::span<const std::uint8_t> bytes) {
  // A log may begin in mid-record: what counts is that there is a record near its beginning.
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
