#include "tank_logs.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "bench/tank_range.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/sim/scene.hpp"
#include "pingvox/sim/sonar.hpp"

namespace pingvox::bench {
namespace {

std::optional<double> simulated_wall_m(double bearing_rad) {
  return true_range_m(TankOptions{}, bearing_rad);
}

std::optional<double> recorded_wall_m(double bearing_rad) {
  constexpr std::array<double, 4> kDistances_m = {2.109, 1.820, 2.325, 2.766};  // ahead, right, behind, left
  const double clockwise = 2.0 * std::numbers::pi - bearing_rad;
  if (clockwise > 255.0 * kDegree_rad && clockwise < 285.0 * kDegree_rad) return std::nullopt;  // the floater
  for (std::size_t side = 0; side < 4; ++side) {
    const double off =
        std::remainder(clockwise + 0.0253 - 0.5 * std::numbers::pi * static_cast<double>(side), 2.0 * std::numbers::pi);
    if (std::abs(off) <= 33.0 * kDegree_rad) return kDistances_m[side] / std::cos(off);
  }
  return std::nullopt;
}

}  // namespace

TankLog simulated_tank() {
  SonarSimulator sonar(tank_scene({}).world, Trajectory::still(Pose::Identity()), {}, 10);
  TankLog log{.name = "simulated", .beams = {}, .sweeps = {}, .wall_m = &simulated_wall_m};
  if (auto beams = read_all(sonar)) log.beams = std::move(*beams);  // a simulator does not fail
  log.sweeps = sweeps_of(log.beams);
  return log;
}

Result<std::optional<TankLog>> recorded_tank() {
  const auto path = std::filesystem::path(PINGVOX_SHARED_DATA) / "tank-static-mat" / "dataset_static.mat";
  if (!std::filesystem::exists(path)) return std::optional<TankLog>();
  Result<FileBytes> file = read_file(path.string());
  if (!file) return tl::unexpected(file.error());
  const auto source = open_beams(std::move(*file));
  if (!source) return tl::unexpected(source.error());
  Result<std::vector<Beam>> beams = read_all(**source);
  if (!beams) return tl::unexpected(beams.error());
  TankLog log{.name = "recorded", .beams = std::move(*beams), .sweeps = {}, .wall_m = &recorded_wall_m};
  log.sweeps = sweeps_of(log.beams);
  return std::optional(std::move(log));
}

Result<std::vector<TankLog>> tank_logs() {
  std::vector<TankLog> logs;
  logs.push_back(simulated_tank());
  Result<std::optional<TankLog>> recorded = recorded_tank();
  if (!recorded) return tl::unexpected(recorded.error());
  if (*recorded) logs.push_back(std::move(**recorded));
  return logs;
}

void EchoJudgement::add(std::optional<double> wall_m, std::optional<double> echo_m) {
  if (!wall_m) return;
  ++judged;
  if (!echo_m) {
    ++missed;
  } else {
    ++(std::abs(*echo_m - *wall_m) <= 0.1 ? right : wrong);
  }
}

EchoJudgement judge_echoes(const TankLog& log, const FilterOptions& filter, const EchoOptions& echo) {
  EchoJudgement judgement;
  for (const Sweep& sweep : log.sweeps) {
    const auto echoes = detect_echoes(apply_filter(PolarImage(sweep), filter), sweep, echo);
    for (std::size_t n = 0; n < echoes.size(); ++n) {
      judgement.add(log.wall_m(sweep.beams[n].bearing_rad),
                    echoes[n] ? std::optional(echoes[n]->range_m) : std::nullopt);
    }
  }
  return judgement;
}

}  // namespace pingvox::bench
