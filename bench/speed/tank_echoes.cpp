#include "tank_echoes.hpp"

#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <utility>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/sweep.hpp"

namespace pingvox::bench {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Result<std::vector<std::vector<BeamEcho>>> echoes_of(BeamSource& source) {
  std::vector<std::vector<BeamEcho>> sweeps;
  SweepAssembler assembler;
  const auto add = [&](const std::optional<Sweep>& sweep) {
    if (!sweep || sweep->extent == Sweep::Extent::kCut) return;
    const PolarImage image = filtered(PolarImage(*sweep), usual_filter(Detector::kRise));
    const auto echoes = detect_echoes(image, *sweep, {});
    auto& found = sweeps.emplace_back();
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      if (echoes[i]) found.push_back({sweep->beams[i].bearing_rad, echoes[i]->range_m, echoes[i]->intensity});
    }
  };
  for (;;) {
    Result<std::optional<Beam>> beam = source.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    add(assembler.add(std::move(**beam)));
  }
  add(assembler.finish());
  return sweeps;
}

Eigen::Vector3d as_floats(const Eigen::Vector3d& point_m) {
  return point_m.cast<float>().cast<double>();
}

}  // namespace

Result<TankEchoes> tank_echoes() {
  const std::filesystem::path recording =
      std::filesystem::path(PINGVOX_SHARED_DATA) / "tank-static-mat/dataset_static.mat";
  if (std::filesystem::exists(recording)) {
    auto file = read_file(recording.string());
    if (!file) return tl::unexpected(file.error());
    auto beams = open_beams(std::move(*file));
    if (!beams) return tl::unexpected(beams.error());
    auto sweeps = echoes_of(**beams);
    if (!sweeps) return tl::unexpected(sweeps.error());
    return TankEchoes{"recording", std::move(*sweeps)};
  }
  SonarSimulator simulator(tank_scene({}).world, Trajectory::still(Pose::Identity()), {}, 28);
  auto sweeps = echoes_of(simulator);
  if (!sweeps) return tl::unexpected(sweeps.error());
  return TankEchoes{"simulated", std::move(*sweeps)};
}

PointScan rays_of(const std::vector<BeamEcho>& sweep) {
  PointScan scan;
  for (const BeamEcho& echo : sweep) {
    scan.points_m.push_back(
        as_floats({echo.range_m * std::cos(echo.bearing_rad), echo.range_m * std::sin(echo.bearing_rad), 0.0}));
  }
  return scan;
}

PointScan bundles_of(const std::vector<BeamEcho>& sweep, int across, int up) {
  PointScan scan;
  for (const BeamEcho& echo : sweep) {
    for (int u = 0; u < up; ++u) {
      const double elevation = 35.0 * kDegree * ((u + 0.5) / up - 0.5);
      for (int a = 0; a < across; ++a) {
        const double bearing = echo.bearing_rad + 3.0 * kDegree * ((a + 0.5) / across - 0.5);
        const Eigen::Vector3d direction(std::cos(elevation) * std::cos(bearing),
                                        std::cos(elevation) * std::sin(bearing), std::sin(elevation));
        scan.points_m.push_back(as_floats(echo.range_m * direction));
      }
    }
  }
  return scan;
}

}  // namespace pingvox::bench
