#include "accuracy/recording.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace pingvox::bench {
namespace {

Result<Scene> find_scene(std::string_view world) {
  if (world == "tank") return tank_scene({});
  if (world == "harbour") return harbour_scene({});
  if (world == "harbour, no hull") return harbour_scene({.hull_length_m = 0.0});
  if (world == "seabed") return seabed_scene({});
  if (world == "cave") return cave_scene({});
  return fail(Error::Code::kBadOption, fmt::format("there is no world '{}'", world));
}

/// Adds vertical oscillations to a trajectory.
Trajectory add_heave(const Trajectory& way, double heave_m) {
  constexpr double kTimes = 5.0;
  std::vector<StampedPose> poses = way.poses();
  const double duration_s = poses.back().time_s - poses.front().time_s;
  for (StampedPose& pose : poses) {
    const double phase = 2.0 * std::numbers::pi * kTimes * (pose.time_s - poses.front().time_s) / duration_s;
    pose.map_from_body.translation().z() += heave_m * std::sin(phase);
  }
  return *Trajectory::make(std::move(poses));
}

Trajectory way_of(const RecordingOptions& options, const Scene& scene, const SonarOptions& sonar) {
  const Route* route = scene.route(options.motion);
  if (!route) return Trajectory::still(Pose::Identity());
  const double duration_s =
      static_cast<double>(options.turns) * static_cast<double>(sonar.beams_per_turn) / sonar.beams_per_s;
  const Trajectory way = follow_route(*route, duration_s, {.speed_m_s = options.speed_m_s});
  return options.heave_m > 0.0 ? add_heave(way, options.heave_m) : way;
}

}  // namespace

Result<Recording> record(const RecordingOptions& options) {
  Result<Scene> scene = find_scene(options.world);
  if (!scene) return tl::unexpected(scene.error());
  Recording recording{.options = options, .scene = *std::move(scene), .sonar = {}, .sweeps = {}, .pings = {}};
  SonarOptions& sonar = recording.sonar;
  sonar.seed = options.seed;
  sonar.beams_per_turn = options.beams;
  sonar.bin_length_m = recording.scene.sonar_range_m / static_cast<double>(sonar.bins);
  SonarSimulator simulator(recording.scene.world, way_of(options, recording.scene, sonar), sonar, options.turns);
  SweepAssembler assembler;
  const auto keep = [&recording](std::optional<Sweep> sweep) {
    if (sweep) recording.sweeps.push_back(*std::move(sweep));
  };
  for (;;) {
    Result<std::optional<Beam>> beam = simulator.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    recording.pings.push_back(simulator.ping());
    keep(assembler.add(std::move(**beam)));
  }
  keep(assembler.finish());
  return recording;
}

}  // namespace pingvox::bench
