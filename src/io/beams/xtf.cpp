#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/bytes/byte_reader.hpp"
#include "io/readers.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "pingvox/sonar/beam.hpp"

// Multibeam lines in Triton's eXtended Format: of its packets those with a ping of an R2Sonic (docs/formats.md).
namespace pingvox {
namespace {

/// Of the deepest sea, give or take.
constexpr double kMaxSounding_m = 10'000.0;

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kFileHeader = 1024, kPacketHeader = 14, kPingHeader = 256;
constexpr std::uint8_t kQinsyR2Sonic = 65;

template <class T>
T little(Bytes bytes, std::size_t place) {
  return value_from<T>(bytes.subspan(place, sizeof(T)), std::endian::little);
}
template <class T>
T big(Bytes bytes, std::size_t place) {
  return value_from<T>(bytes.subspan(place, sizeof(T)), std::endian::big);
}

bool has_mark(Bytes bytes, std::size_t place) {
  return bytes.size() - place >= 2 && bytes[place] == 0xce && bytes[place + 1] == 0xfa;
}

/// A packet at `place`, with another one or the end of the file behind it.
std::optional<Bytes> packet_at(Bytes file, std::size_t place) {
  if (file.size() - place < kPacketHeader || !has_mark(file, place)) return std::nullopt;
  const std::size_t size = little<std::uint32_t>(file, place + 10);
  if (size < kPacketHeader || size > file.size() - place) return std::nullopt;
  if (place + size < file.size() && !has_mark(file, place + size)) return std::nullopt;
  return file.subspan(place, size);
}

/// Where the next packet from `place` on begins; the end of the file: there is none.
std::size_t find_packet(Bytes file, std::size_t place) {
  while (place < file.size() && !packet_at(file, place)) {
    const auto* found = static_cast<const std::uint8_t*>(
        place + 1 < file.size() ? std::memchr(file.data() + place + 1, 0xce, file.size() - place - 1) : nullptr);
    place = found != nullptr ? static_cast<std::size_t>(found - file.data()) : file.size();
  }
  return place;
}

/// Where the head was.
struct HeadPose {
  Eigen::Vector3d place;  ///< latitude, longitude [rad], or north, east [m]; heave [m]
  double roll_rad, pitch_rad, heading_rad;
};

/// A value or, in a few words, why a ping has none.
template <class T>
using OrReason = tl::expected<T, std::string>;

OrReason<HeadPose> head_pose(Bytes packet, bool has_degrees) {
  const double unit = has_degrees ? kDegree_rad : 1.0;
  HeadPose head;
  head.place = {little<double>(packet, 160) * unit, little<double>(packet, 168) * unit, little<float>(packet, 216)};
  head.pitch_rad = little<float>(packet, 204) * kDegree_rad;
  head.roll_rad = little<float>(packet, 208) * kDegree_rad;
  head.heading_rad = little<float>(packet, 212) * kDegree_rad;
  const bool is_finite = head.place.allFinite() && std::isfinite(head.pitch_rad) && std::isfinite(head.roll_rad) &&
                         std::isfinite(head.heading_rad);
  if (!is_finite) return tl::unexpected(std::string("a ping whose position or attitude is not a number"));
  constexpr double kMaxPosition_m = 1e8, kPole_deg = 90.0, kHalfTurn_deg = 180.0;
  const double first = head.place.x() / unit, second = head.place.y() / unit;
  // What a receiver sends before its first fix.
  if (has_degrees && first == 0.0 && second == 0.0) {
    return tl::unexpected(std::string("a ping without a position: latitude and longitude are 0"));
  }
  const bool is_place = has_degrees ? std::fabs(first) <= kPole_deg && std::fabs(second) <= kHalfTurn_deg
                                    : std::max(std::fabs(first), std::fabs(second)) <= kMaxPosition_m;
  if (!is_place) {
    return tl::unexpected(fmt::format("a ping at {:.7g}, {:.7g}, which is no {}", first, second,
                                      has_degrees ? "latitude and longitude in degrees" : "northing and easting"));
  }
  if (std::fabs(head.place.z()) > kMaxSounding_m) {
    return tl::unexpected(fmt::format("a ping with a heave of {:.6g} m", head.place.z()));
  }
  return head;
}

/// The sections of R2Sonic's BTH0 packet, big-endian: a name of two characters, a size, values.
struct Sections {
  Bytes settings, times, angles;  ///< H0, R0, A2

  static Sections of(Bytes ping) {
    constexpr std::size_t kHead = 12;
    Sections sections;
    if (ping.size() < kHead || std::memcmp(ping.data(), "BTH0", 4) != 0) return sections;
    for (Bytes rest = ping.subspan(kHead); rest.size() >= 4;) {
      const std::size_t size = big<std::uint16_t>(rest, 2);
      if (size < 4 || size > rest.size()) break;
      const Bytes section = rest.first(size);
      if (std::memcmp(section.data(), "H0", 2) == 0) sections.settings = section;
      if (std::memcmp(section.data(), "R0", 2) == 0) sections.times = section;
      if (std::memcmp(section.data(), "A2", 2) == 0) sections.angles = section;
      rest = rest.subspan(size);
    }
    return sections;
  }
};

/// The points of a ping in the frame of the head, ahead, to port, up.
OrReason<std::vector<Eigen::Vector3d>> points_of(Bytes ping) {
  constexpr std::size_t kSettings = 116, kTimes = 8, kAngles = 36;
  constexpr double kSlowest_m_s = 1000.0, kFastest_m_s = 2000.0;
  const auto [settings, times, angles] = Sections::of(ping);
  const std::size_t count = settings.size() < kSettings ? 0 : big<std::uint16_t>(settings, 114);
  if (settings.size() < kSettings || times.size() < kTimes + 2 * count || angles.size() < kAngles + 2 * count) {
    return tl::unexpected(std::string("a ping without all of its sections H0, R0 and A2"));
  }
  const double sound_speed_m_s = big<float>(settings, 44);
  const double tick_s = big<float>(times, 4), step_rad = big<float>(angles, 8);
  double angle_rad = big<float>(angles, 4);  // to starboard of straight down
  if (!(sound_speed_m_s > kSlowest_m_s && sound_speed_m_s < kFastest_m_s)) {
    return tl::unexpected(fmt::format("a ping with a sound speed of {:.6g} m/s", sound_speed_m_s));
  }
  if (!(tick_s > 0.0)) return tl::unexpected(fmt::format("a ping that counts times in {:.6g} s", tick_s));
  std::vector<Eigen::Vector3d> points_m;
  for (std::size_t i = 0; i < count; ++i) {
    angle_rad += step_rad * big<std::uint16_t>(angles, kAngles + 2 * i);
    const double range_m = tick_s * big<std::uint16_t>(times, kTimes + 2 * i) * sound_speed_m_s / 2.0;
    if (!(range_m <= kMaxSounding_m)) return tl::unexpected(fmt::format("a ping with a range of {:.6g} m", range_m));
    if (!(std::fabs(angle_rad) <= std::numbers::pi)) {
      return tl::unexpected(fmt::format("a ping with an angle of {:.6g} rad", angle_rad));
    }
    if (range_m > 0.0) points_m.emplace_back(0.0, -range_m * std::sin(angle_rad), -range_m * std::cos(angle_rad));
  }
  return points_m;
}

bool has_degrees(Bytes file) {
  constexpr std::uint16_t kLatitudeLongitude = 3;
  return little<std::uint16_t>(file, 164) == kLatitudeLongitude;
}

class XtfSource final : public ScanSource {
 public:
  XtfSource(FileBytes file, Damage damage)
      : file_(std::move(file)), damage_(damage), has_degrees_(has_degrees(file_.view())) {}

  Result<std::optional<PointScan>> next() override {
    while (place_ < file_.bytes.size()) {
      const std::optional<Bytes> packet = packet_at(file_.view(), place_);
      if (!packet) {
        const std::size_t damaged = std::exchange(place_, find_packet(file_.view(), place_ + 1));
        if (const auto left_out = leave_out(damaged, "no whole packet is here"); !left_out) {
          return tl::unexpected(left_out.error());
        }
        continue;
      }
      const std::size_t at = place_;
      place_ += packet->size();
      if ((*packet)[2] != kQinsyR2Sonic) continue;
      const std::size_t number = pings_++;
      OrReason<PointScan> scan = scan_of(*packet);
      if (scan) {
        scan->number = number;
        return *std::move(scan);
      }
      if (const auto left_out = leave_out(at, scan.error()); !left_out) {
        return tl::unexpected(left_out.error());
      }
    }
    return std::nullopt;
  }

  std::size_t skipped() const override { return skipped_.count; }
  std::string first_damage() const override { return skipped_.first; }
  std::optional<double> share_read() const override {
    return read_share(file_.bytes.size() - place_, file_.bytes.size());
  }

 private:
  Result<void> leave_out(std::size_t at, const std::string& reason) {
    return handle_damage(damage_, skipped_, file_.name, fmt::format("byte {}", at), reason);
  }

  OrReason<PointScan> scan_of(Bytes packet) {
    if (packet.size() < kPingHeader) return tl::unexpected(std::string("a ping without a whole header"));
    const OrReason<HeadPose> head = head_pose(packet, has_degrees_);
    if (!head) return tl::unexpected(head.error());
    const OrReason<std::vector<Eigen::Vector3d>> points_m = points_of(packet.subspan(kPingHeader));
    if (!points_m) return tl::unexpected(points_m.error());
    if (!origin_) origin_ = Eigen::Vector3d(head->place.x(), head->place.y(), 0.0);
    const Eigen::Vector3d moved = head->place - *origin_;
    const Eigen::Vector3d position_m =
        has_degrees_ ? position_of_fix(head->place, *origin_) : Eigen::Vector3d(moved.y(), moved.x(), moved.z());
    const Pose map_from_head =
        pose_from_rpy(position_m, head->roll_rad, -head->pitch_rad, std::numbers::pi / 2.0 - head->heading_rad);
    PointScan scan;
    scan.origin_m = position_m;
    scan.rotation = Eigen::Quaterniond(map_from_head.linear());
    for (const Eigen::Vector3d& point_m : *points_m) scan.points_m.push_back(map_from_head * point_m);
    return scan;
  }

  FileBytes file_;
  Damage damage_;
  bool has_degrees_;
  std::size_t place_ = kFileHeader;
  std::size_t pings_ = 0;  ///< damaged ones as well
  std::optional<Eigen::Vector3d> origin_;
  SkippedRecords skipped_;
};

/// The types of a file's packets, as text.
std::string types_in(Bytes file) {
  std::set<unsigned> types;
  for (std::size_t place = kFileHeader; place < file.size();) {
    const std::optional<Bytes> packet = packet_at(file, place);
    if (packet) types.insert((*packet)[2]);
    place = packet ? place + packet->size() : find_packet(file, place + 1);
  }
  if (types.contains(kQinsyR2Sonic)) return {};
  std::string text;
  for (const unsigned type : types) text += fmt::format("{}{}", text.empty() ? "" : ", ", type);
  return text.empty() ? "none" : text;
}

/// Where the positions of a file in metres are latitudes and longitudes in degrees: all are some, and a survey of ten
/// pings moves by no more than centimetres. Empty: nowhere.
std::string fault_of_unit(Bytes file) {
  constexpr double kMaxMoved_m = 0.05, kPole = 90.0, kHalfTurn = 180.0;
  constexpr std::size_t kMinPlaces = 10;
  if (has_degrees(file)) return {};
  std::vector<Eigen::Vector2d> places;
  for (std::size_t place = kFileHeader; place < file.size();) {
    const std::optional<Bytes> packet = packet_at(file, place);
    place = packet ? place + packet->size() : find_packet(file, place + 1);
    if (!packet || (*packet)[2] != kQinsyR2Sonic || packet->size() < kPingHeader) continue;
    const OrReason<HeadPose> head = head_pose(*packet, false);
    if (!head) continue;
    places.emplace_back(head->place.x(), head->place.y());
    if (std::fabs(places.back().x()) > kPole || std::fabs(places.back().y()) > kHalfTurn) return {};
    if ((places.back() - places.front()).norm() > kMaxMoved_m) return {};
  }
  const bool moves = std::ranges::any_of(places, [&](const Eigen::Vector2d& place) { return place != places.front(); });
  if (places.size() < kMinPlaces || !moves) return {};
  return fmt::format(
      "its positions are in metres by its header and stay within {:.6g} m of {:.6g}, {:.6g}: are they in "
      "degrees (unit 3)?",
      kMaxMoved_m, places.front().x(), places.front().y());
}

}  // namespace

bool looks_like_xtf(Bytes bytes) {
  constexpr std::uint8_t kMark = 123;
  return bytes.size() >= kFileHeader + kPacketHeader && bytes[0] == kMark && has_mark(bytes, kFileHeader);
}

Result<std::unique_ptr<ScanSource>> open_xtf(FileBytes file, Damage damage) {
  if (const std::string types = types_in(file.view()); !types.empty()) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: is an XTF file without pings of an R2Sonic multibeam (packets of type 65): its "
                            "packets are of type {}",
                            file.name, types));
  }
  if (const std::string fault = fault_of_unit(file.view()); !fault.empty()) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}", file.name, fault));
  }
  return std::make_unique<XtfSource>(std::move(file), damage);
}

}  // namespace pingvox
