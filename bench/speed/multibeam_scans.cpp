#include "multibeam_scans.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/sim/scene.hpp"

namespace pingvox::bench {
namespace {

constexpr std::size_t kPings = 300, kBeams = 256;
constexpr double kDegree = std::numbers::pi / 180.0;

using Bytes = std::span<const std::uint8_t>;

/// A number at an offset, 0 beyond the end.
template <class T, std::endian kOrder>
T number(Bytes bytes, std::size_t at) {
  std::uint8_t raw[sizeof(T)] = {};
  if (at + sizeof(T) > bytes.size()) return T{};
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    raw[kOrder == std::endian::native ? i : sizeof(T) - 1 - i] = bytes[at + i];
  }
  T value;
  std::memcpy(&value, raw, sizeof value);
  return value;
}
template <class T>
T little(Bytes bytes, std::size_t at) {
  return number<T, std::endian::little>(bytes, at);
}
template <class T>
T big(Bytes bytes, std::size_t at) {
  return number<T, std::endian::big>(bytes, at);
}

/// A sounding in the plane across the track.
struct Sounding {
  double angle_rad = 0.0;  ///< from straight down, to starboard
  double range_m = 0.0;
};

/// A ping of the recording.
struct Ping {
  double latitude_rad = 0.0, longitude_rad = 0.0;
  double heading_rad = 0.0, pitch_rad = 0.0, roll_rad = 0.0, heave_m = 0.0;
  std::vector<Sounding> soundings;
};

/// A QINSy packet: an XTF ping header, then R2Sonic's sections, of which R0 holds the times and A2 the angles.
Ping ping_in(Bytes packet) {
  Ping ping{.latitude_rad = little<double>(packet, 128) * kDegree,
            .longitude_rad = little<double>(packet, 136) * kDegree,
            .heading_rad = little<float>(packet, 212) * kDegree,
            .pitch_rad = little<float>(packet, 204) * kDegree,
            .roll_rad = little<float>(packet, 208) * kDegree,
            .heave_m = little<float>(packet, 216),
            .soundings = {}};
  constexpr std::size_t kHeader = 256, kMagic = 12, kName = 4;
  const double sound_m_s = 2.0 * static_cast<double>(little<float>(packet, 32));  // XTF holds half of it
  std::vector<Sounding> soundings(kBeams);
  const Bytes body = packet.subspan(std::min(packet.size(), kHeader + kMagic));
  for (std::size_t at = 0; at + kName <= body.size();) {
    const std::size_t size = big<std::uint16_t>(body, at + 2);
    if (size < kName || at + size > body.size()) break;
    const Bytes section = body.subspan(at, size);
    if (section[0] == 'R') {
      const double scale_s = big<float>(section, 4);
      for (std::size_t i = 0; i < kBeams; ++i) {
        soundings[i].range_m = 0.5 * sound_m_s * scale_s * big<std::uint16_t>(section, 8 + 2 * i);
      }
    } else if (section[0] == 'A') {
      const double scale_rad = big<float>(section, 8);
      double angle_rad = big<float>(section, 4);
      for (std::size_t i = 0; i < kBeams; ++i) {
        angle_rad += scale_rad * big<std::uint16_t>(section, 36 + 2 * i);
        soundings[i].angle_rad = angle_rad;
      }
    }
    at += size;
  }
  for (const Sounding& sounding : soundings) {
    if (sounding.range_m > 0.0 && std::isfinite(sounding.range_m)) ping.soundings.push_back(sounding);
  }
  return ping;
}

std::vector<Ping> pings_in(Bytes file) {
  constexpr std::size_t kFileHeader = 1024, kPacketHeader = 14;
  constexpr std::uint8_t kR2Sonic = 65;
  std::vector<Ping> pings;
  for (std::size_t at = kFileHeader; at + kPacketHeader <= file.size() && pings.size() < kPings;) {
    const std::size_t size = little<std::uint32_t>(file, at + 10);
    if (little<std::uint16_t>(file, at) != 0xFACE || size < kPacketHeader || at + size > file.size()) break;
    if (file[at + 2] == kR2Sonic) pings.push_back(ping_in(file.subspan(at, size)));
    at += size;
  }
  return pings;
}

RayCloud scan_of(const Pose& map_from_sensor, std::span<const Sounding> soundings) {
  RayCloud scan{map_from_sensor.translation().cast<float>(), {}};
  for (const Sounding& sounding : soundings) {
    const Eigen::Vector3d way(0.0, -std::sin(sounding.angle_rad), -std::cos(sounding.angle_rad));
    scan.ends_m.emplace_back((map_from_sensor * (sounding.range_m * way)).cast<float>());
  }
  return scan;
}

/// Scans in east, north, up relative to the first ping.
std::vector<RayCloud> scans_of(const std::vector<Ping>& pings) {
  constexpr double kEarth_m = 6371e3;
  std::vector<RayCloud> scans;
  for (const Ping& ping : pings) {
    const Ping& first = pings.front();
    const Eigen::Vector3d at(kEarth_m * std::cos(first.latitude_rad) * (ping.longitude_rad - first.longitude_rad),
                             kEarth_m * (ping.latitude_rad - first.latitude_rad), ping.heave_m);
    const Pose pose(Eigen::Translation3d(at) *
                    Eigen::AngleAxisd(0.5 * std::numbers::pi - ping.heading_rad, Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(-ping.pitch_rad, Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(ping.roll_rad, Eigen::Vector3d::UnitX()));
    scans.push_back(scan_of(pose, ping.soundings));
  }
  return scans;
}

/// The same angles over a seabed as deep, 19 pings a second at 1.5 m/s.
std::vector<RayCloud> simulated_scans() {
  constexpr double kWay_m = 1.5 / 19.0, kHalfWidth_rad = 61.5 * kDegree, kRange_m = 100.0;
  const Scene scene = seabed_scene({.side_m = 100.0, .depth_m = 12.0});
  std::vector<RayCloud> scans;
  for (std::size_t i = 0; i < kPings; ++i) {
    const Pose pose(Eigen::Translation3d(kWay_m * (static_cast<double>(i) - 0.5 * kPings), 0.0, 0.0));
    std::vector<Sounding> soundings;
    for (std::size_t beam = 0; beam < kBeams; ++beam) {
      const double angle = kHalfWidth_rad * (2.0 * static_cast<double>(beam) / (kBeams - 1) - 1.0);
      const Eigen::Vector3d way(0.0, -std::sin(angle), -std::cos(angle));
      if (const auto met = scene.world.first({pose.translation(), way}, kRange_m)) {
        soundings.push_back({angle, met->range_m});
      }
    }
    scans.push_back(scan_of(pose, soundings));
  }
  return scans;
}

}  // namespace

Result<MultibeamScans> multibeam_scans() {
  const std::filesystem::path recording =
      std::filesystem::path(PINGVOX_SHARED_DATA) / "mbes-r2sonic-sfbay/0009_150708_R2Testing_0001.xtf";
  if (!std::filesystem::exists(recording)) return MultibeamScans{"simulated", simulated_scans()};
  const auto file = read_file(recording.string());
  if (!file) return tl::unexpected(file.error());
  const std::vector<Ping> pings = pings_in(file->view());
  if (pings.size() < kPings) {
    return fail(Error::Code::kCorrupt, fmt::format("{}: has {} pings, not {}", file->name, pings.size(), kPings));
  }
  return MultibeamScans{"recording", scans_of(pings)};
}

}  // namespace pingvox::bench
