#include "multibeam_scans.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/geometry/pose.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/sim/scene.hpp"

namespace pingvox::bench {
namespace {

constexpr std::size_t kPings = 300, kBeams = 256;

/// A sounding in the plane across the track.
struct Sounding {
  double angle_rad = 0.0;  ///< from straight down, to starboard
  double range_m = 0.0;
};

RayCloud scan_of(const Pose& map_from_sensor, std::span<const Sounding> soundings) {
  RayCloud scan{map_from_sensor.translation().cast<float>(), {}};
  for (const Sounding& sounding : soundings) {
    const Eigen::Vector3d way(0.0, -std::sin(sounding.angle_rad), -std::cos(sounding.angle_rad));
    scan.ends_m.emplace_back((map_from_sensor * (sounding.range_m * way)).cast<float>());
  }
  return scan;
}

/// The same angles over a seabed as deep, 19 pings a second at 1.5 m/s.
std::vector<RayCloud> simulated_scans() {
  constexpr double kWay_m = 1.5 / 19.0, kHalfWidth_rad = 61.5 * kDegree_rad, kRange_m = 100.0;
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
  Result<FileBytes> file = read_file(recording.string());
  if (!file) return tl::unexpected(file.error());
  const auto source = open_scans(*std::move(file));
  if (!source) return tl::unexpected(source.error());
  std::vector<RayCloud> scans;
  while (scans.size() < kPings) {
    const Result<std::optional<PointScan>> scan = (*source)->next();
    if (!scan) return tl::unexpected(scan.error());
    if (!*scan) {
      return fail(Error::Code::kCorrupt,
                  fmt::format("{}: has {} pings, not {}", recording.string(), scans.size(), kPings));
    }
    RayCloud& cloud = scans.emplace_back(RayCloud{(*scan)->origin_m.cast<float>(), {}});
    for (const Eigen::Vector3d& point_m : (*scan)->points_m) cloud.ends_m.emplace_back(point_m.cast<float>());
  }
  return MultibeamScans{"recording", std::move(scans)};
}

}  // namespace pingvox::bench
