#include "tank_echoes.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "bench/tank_beams.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox::bench {
namespace {

std::vector<std::vector<BeamEcho>> echoes_of(std::span<const Beam> beams) {
  std::vector<std::vector<BeamEcho>> sweeps;
  for (const Sweep& sweep : sweeps_of(beams)) {
    if (sweep.extent == Sweep::Extent::kCut) continue;
    const PolarImage image = apply_filter(PolarImage(sweep), default_filter(Detector::kRise));
    const auto echoes = detect_echoes(image, sweep, {});
    auto& found = sweeps.emplace_back();
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      if (echoes[i]) found.push_back({sweep.beams[i].bearing_rad, echoes[i]->range_m, echoes[i]->intensity});
    }
  }
  return sweeps;
}

}  // namespace

Result<TankEchoes> tank_echoes() {
  Result<TankBeams> tank = tank_beams();
  if (!tank) return tl::unexpected(tank.error());
  return TankEchoes{std::move(tank->input), echoes_of(tank->beams)};
}

RayCloud rays_of(const std::vector<BeamEcho>& sweep) {
  RayCloud cloud;
  for (const BeamEcho& echo : sweep) {
    const Eigen::Vector3d direction(std::cos(echo.bearing_rad), std::sin(echo.bearing_rad), 0.0);
    cloud.ends_m.emplace_back((echo.range_m * direction).cast<float>());
  }
  return cloud;
}

RayCloud bundles_of(const std::vector<BeamEcho>& sweep, int across, int up) {
  RayCloud cloud;
  for (const BeamEcho& echo : sweep) {
    for (int u = 0; u < up; ++u) {
      const double elevation = 35.0 * kDegree_rad * ((u + 0.5) / up - 0.5);
      for (int a = 0; a < across; ++a) {
        const double bearing = echo.bearing_rad + 3.0 * kDegree_rad * ((a + 0.5) / across - 0.5);
        const Eigen::Vector3d direction(std::cos(elevation) * std::cos(bearing),
                                        std::cos(elevation) * std::sin(bearing), std::sin(elevation));
        cloud.ends_m.emplace_back((echo.range_m * direction).cast<float>());
      }
    }
  }
  return cloud;
}

Result<TankBundles> tank_bundles(std::size_t sweeps) {
  Result<TankEchoes> tank = tank_echoes();
  if (!tank) return tl::unexpected(tank.error());
  TankBundles bundles{std::move(tank->input), {}};
  for (std::size_t i = 0; i < std::min(sweeps, tank->sweeps.size()); ++i) {
    bundles.scans.push_back(bundles_of(tank->sweeps[i], 32, 64));
  }
  return bundles;
}

}  // namespace pingvox::bench
